// SPDX-License-Identifier: Apache-2.0
// A page that holds everything in one HTML file: style, plots and pictures. It loads nothing and
// runs nothing, follows the reader's light or dark scheme, and prints.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ostraka/io/png_file.hpp"

namespace ostraka {

enum class RowStatus { kNone, kGood, kBad };

struct TableRow {
    std::vector<std::string> cells;       ///< at most as many as the header has; the rest is empty
    RowStatus status = RowStatus::kNone;  ///< colored and marked with a sign
    bool emphasis = false;                ///< bold: a total, the best
};

struct Table {
    std::vector<std::string> header;
    std::vector<TableRow> rows;
    std::string caption;           ///< above the table; empty: none
    std::size_t text_columns = 1;  ///< from the left, aligned left; the others are numbers
};

/// A number large enough to be read first: "98.9 %", "recall", "95 % interval 97.1 to 99.8 %".
struct Fact {
    std::string value;
    std::string label;
    std::string note;  ///< empty: none
};

struct Figure {
    std::string svg;      ///< one <svg> element, as draw_svg() gives it; put in as it is
    std::string caption;  ///< empty: none
};

struct Picture {
    Image image;
    std::string caption;  ///< empty: none
    std::string alt;      ///< what it shows, for those who can't see it
};

/// What a page holds, from top to bottom. All text may come from anywhere: it is escaped.
class PageContent {
  public:
    /// @param level  2 (a section, listed in the page's contents) to 4. @throws InvalidInput.
    void heading(std::string_view text, int level = 2);
    void paragraph(std::string_view text);
    /// A paragraph in small print.
    void note(std::string_view text);
    void list(std::span<const std::string> items);
    void facts(std::span<const Fact> facts);
    /// @throws InvalidInput if a row has more cells than the header.
    void table(const Table& table);
    void figure(std::string_view svg, std::string_view caption = {});
    /// Side by side, two a row.
    void figures(std::span<const Figure> figures);
    /// At its own size, or the page's width if that is less. @throws InvalidInput if it is empty.
    void picture(const Image& image, std::string_view caption, std::string_view alt);
    /// Side by side, up to four a row, equally wide. @throws InvalidInput if one is empty.
    void pictures(std::span<const Picture> pictures);
    /// Content that unfolds when its summary is clicked, and is printed unfolded.
    void details(std::string_view summary, const PageContent& inner, bool open = false);
    void preformatted(std::string_view text);

    /// The content as HTML. @param anchors  sections can be linked to, as #s1, #s2 and so on.
    std::string html(bool anchors = false) const;
    /// Names of the sections (headings of level 2).
    std::vector<std::string> sections() const;

  private:
    struct Section {
        std::size_t offset = 0;  // of its heading in body_, behind "<h2"
        std::string name;
    };
    std::string body_;
    std::vector<Section> sections_;
};

struct PageSettings {
    std::string title;
    std::string subtitle;  ///< below the title; empty: none
    std::string footer;    ///< in small print at the end: version, date, command; empty: none
    bool contents = true;  ///< links to the sections if there are three or more
};

/// The whole document, UTF-8. The same bytes for the same content.
std::string html_page(const PageSettings& settings, const PageContent& content);

}  // namespace ostraka
