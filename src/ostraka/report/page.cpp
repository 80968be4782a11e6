// SPDX-License-Identifier: Apache-2.0
#include "ostraka/report/page.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "ostraka/base/error.hpp"
#include "ostraka/report/markup.hpp"
#include "ostraka/report/page_style.hpp"

namespace ostraka {
namespace {

// Text that is broken into lines, though not between a number and its percent sign.
std::string prose(std::string_view text) {
    constexpr std::string_view kFixedSpace = "\xC2\xA0";
    std::string html = escape_html(text);
    for (std::size_t i = 1; i + 1 < html.size(); ++i) {
        if (html[i] != ' ' || html[i + 1] != '%' || html[i - 1] < '0' || html[i - 1] > '9')
            continue;
        html.replace(i, 1, kFixedSpace);
    }
    return html;
}

std::string element(std::string_view tag, std::string_view text) {
    return fmt::format("<{0}>{1}</{0}>\n", tag, prose(text));
}

std::string figure_html(std::string_view inner, std::string_view caption) {
    std::string html = fmt::format("<figure>{}", inner);
    if (!caption.empty()) html += fmt::format("<figcaption>{}</figcaption>", prose(caption));
    return html + "</figure>\n";
}

std::string picture_html(const Image& image, std::string_view caption, std::string_view alt) {
    return figure_html(
        fmt::format(R"(<img width="{}" height="{}" alt="{}" src="data:image/png;base64,{}"/>)",
                    image.width, image.height, escape_html(alt), base64(encode_png(image))),
        caption);
}

// Color alone isn't told by everybody or every printer: a sign says the same.
constexpr std::string_view status_class(RowStatus status) {
    switch (status) {
        case RowStatus::kGood:
            return "good";
        case RowStatus::kBad:
            return "bad";
        case RowStatus::kNone:
            break;
    }
    return "";
}

std::string row_html(const Table& table, const TableRow& row) {
    std::string classes(status_class(row.status));
    if (row.emphasis) classes += classes.empty() ? "strong" : " strong";
    std::string html = classes.empty() ? "<tr>" : fmt::format(R"(<tr class="{}">)", classes);
    for (std::size_t c = 0; c < table.header.size(); ++c) {
        const std::string cell = c < row.cells.size() ? escape_html(row.cells[c]) : std::string();
        if (c == 0) {
            html += fmt::format(R"(<th scope="row">{}</th>)", cell);
        } else {
            html += fmt::format(R"(<td{}>{}</td>)",
                                c < table.text_columns ? R"( class="text")" : "", cell);
        }
    }
    return html + "</tr>\n";
}

std::string contents_html(const std::vector<std::string>& sections) {
    std::string html = R"(<nav aria-label="Contents"><ol>)";
    for (std::size_t i = 0; i < sections.size(); ++i) {
        html += fmt::format(R"(<li><a href="#s{}">{}</a></li>)", i + 1, escape_html(sections[i]));
    }
    return html + "</ol></nav>\n";
}

}  // namespace

void PageContent::heading(std::string_view text, int level) {
    if (level < 2 || level > 4) {
        throw InvalidInput(fmt::format("page: heading of level {}", level));
    }
    if (level == 2) sections_.push_back({body_.size() + 3, std::string(text)});
    body_ += element(fmt::format("h{}", level), text);
}

void PageContent::paragraph(std::string_view text) {
    body_ += element("p", text);
}

void PageContent::note(std::string_view text) {
    body_ += fmt::format("<p class=\"note\">{}</p>\n", prose(text));
}

void PageContent::list(std::span<const std::string> items) {
    if (items.empty()) return;
    body_ += "<ul>\n";
    for (const std::string& item : items) body_ += element("li", item);
    body_ += "</ul>\n";
}

void PageContent::facts(std::span<const Fact> facts) {
    if (facts.empty()) return;
    body_ += "<dl class=\"facts\">\n";
    for (const Fact& fact : facts) {
        body_ += fmt::format(R"(<div><dt>{}</dt><dd class="value">{}</dd>)",
                             escape_html(fact.label), escape_html(fact.value));
        if (!fact.note.empty()) {
            body_ += fmt::format(R"(<dd class="note">{}</dd>)", prose(fact.note));
        }
        body_ += "</div>\n";
    }
    body_ += "</dl>\n";
}

void PageContent::table(const Table& table) {
    for (const TableRow& row : table.rows) {
        if (row.cells.size() > table.header.size()) {
            throw InvalidInput(fmt::format("page: a row of {} cells in a table of {} columns",
                                           row.cells.size(), table.header.size()));
        }
    }
    if (table.header.empty()) return;
    body_ += "<div class=\"table\"><table>\n";
    if (!table.caption.empty()) body_ += element("caption", table.caption);
    body_ += "<thead><tr>";
    for (std::size_t c = 0; c < table.header.size(); ++c) {
        body_ += fmt::format(R"(<th scope="col"{}>{}</th>)",
                             c > 0 && c < table.text_columns ? R"( class="text")" : "",
                             escape_html(table.header[c]));
    }
    body_ += "</tr></thead>\n<tbody>\n";
    for (const TableRow& row : table.rows) body_ += row_html(table, row);
    if (table.rows.empty()) {
        body_ += fmt::format(R"(<tr><td class="text note" colspan="{}">no data</td></tr>)",
                             table.header.size());
    }
    body_ += "</tbody></table></div>\n";
}

void PageContent::figure(std::string_view svg, std::string_view caption) {
    body_ += figure_html(svg, caption);
}

void PageContent::figures(std::span<const Figure> figures) {
    if (figures.empty()) return;
    body_ += "<div class=\"figures\">\n";
    for (const Figure& figure : figures) body_ += figure_html(figure.svg, figure.caption);
    body_ += "</div>\n";
}

void PageContent::picture(const Image& image, std::string_view caption, std::string_view alt) {
    body_ += picture_html(image, caption, alt);
}

void PageContent::pictures(std::span<const Picture> pictures) {
    if (pictures.empty()) return;
    // Rows of up to four, filled evenly: five are three and two, not four and one.
    const std::size_t rows = (pictures.size() + 3) / 4;
    const std::size_t columns = (pictures.size() + rows - 1) / rows;
    body_ += fmt::format("<div class=\"pictures\" style=\"--columns:{}\">\n", columns);
    for (const Picture& picture : pictures) {
        body_ += picture_html(picture.image, picture.caption, picture.alt);
    }
    body_ += "</div>\n";
}

void PageContent::details(std::string_view summary, const PageContent& inner, bool open) {
    body_ += fmt::format("<details{}><summary>{}</summary>\n<div>\n{}</div></details>\n",
                         open ? R"( open="open")" : "", escape_html(summary), inner.html());
}

void PageContent::preformatted(std::string_view text) {
    body_ += fmt::format("<pre>{}</pre>\n", escape_html(text));
}

std::string PageContent::html(bool anchors) const {
    if (!anchors) return body_;
    std::string html;
    std::size_t done = 0;
    for (std::size_t i = 0; i < sections_.size(); ++i) {
        html.append(body_, done, sections_[i].offset - done);
        html += fmt::format(R"( id="s{}")", i + 1);
        done = sections_[i].offset;
    }
    return html.append(body_, done);
}

std::vector<std::string> PageContent::sections() const {
    std::vector<std::string> names;
    for (const Section& section : sections_) names.push_back(section.name);
    return names;
}

std::string html_page(const PageSettings& settings, const PageContent& content) {
    // The policy makes the browser refuse whatever isn't in this file, should any slip in.
    std::string page = fmt::format(
        R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8"/>
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'; img-src data:"/>
<meta name="viewport" content="width=device-width, initial-scale=1"/>
<title>{0}</title>
<style>
{2}</style>
</head>
<body>
<header><h1>{0}</h1>{1}</header>
)",
        escape_html(settings.title),
        settings.subtitle.empty() ? std::string() : element("p", settings.subtitle), page_css());
    const std::vector<std::string> sections = content.sections();
    if (settings.contents && sections.size() >= 3) page += contents_html(sections);
    page += "<main>\n" + content.html(true) + "</main>\n";
    if (!settings.footer.empty()) page += element("footer", settings.footer);
    return page + "</body>\n</html>\n";
}

}  // namespace ostraka
