// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/contradiction.hpp"

#include <algorithm>

#include "ostraka/recognition/verdict_image.hpp"

namespace ostraka {
namespace {

// Cells of a hole where something farther is seen. One alone may be a speck of noise, few of many
// the rim of something that was not measured.
constexpr std::size_t kMinThrough = 2;
constexpr double kMinThroughShare = 0.1;

bool contradicts(CellVerdict verdict) {
    return verdict == CellVerdict::violation || verdict == CellVerdict::backdrop;
}

// What a hole's cells may be: at its rim nothing can be said.
bool may_be_hole(CellVerdict verdict) {
    return contradicts(verdict) || verdict == CellVerdict::missing ||
           verdict == CellVerdict::unsure;
}

// Connected cells that may be a hole.
struct Piece {
    std::vector<std::size_t> cells;  // of the window
    bool enclosed = true;            // by support
};

// Cells of which `holds`, as it does of all eight around them.
template <typename Predicate>
std::size_t inside_pieces(const RangeMap& ranges, std::span<const std::uint32_t> window,
                          std::span<const CellVerdict> verdicts, Predicate holds) {
    if (window.empty()) return 0;
    const VerdictImage image(ranges, window, verdicts);
    return static_cast<std::size_t>(
        std::count_if(window.begin(), window.end(), [&](std::uint32_t cell) {
            for (int n = 0; n < 9; ++n) {
                if (!holds(image.at(image.u(cell) + n % 3 - 1, image.v(cell) + n / 3 - 1)))
                    return false;
            }
            return true;
        }));
}

class Holes {
  public:
    Holes(const VerdictImage& image, std::span<const std::uint32_t> window,
          std::span<const CellVerdict> verdicts, const std::vector<bool>& through)
        : image_(image),
          window_(window),
          verdicts_(verdicts),
          through_(through),
          visited_(window.size(), false) {}

    std::size_t cells_inside() {
        std::size_t sum = 0;
        for (std::size_t i = 0; i < window_.size(); ++i) {
            if (visited_[i] || !through_[i]) continue;
            const Piece piece = piece_around(i);
            if (is_hole(piece)) sum += inside(piece);
        }
        return sum;
    }

  private:
    std::size_t beside(std::size_t cell, const std::pair<int, int>& side) const {
        return image_.index(image_.u(window_[cell]) + side.first,
                            image_.v(window_[cell]) + side.second);
    }
    Piece piece_around(std::size_t start) {
        Piece piece{{start}};
        visited_[start] = true;
        for (std::size_t next = 0; next < piece.cells.size(); ++next) {
            for (const auto& side : kSides) visit(beside(piece.cells[next], side), piece);
        }
        return piece;
    }
    void visit(std::size_t cell, Piece& piece) {
        if (cell == VerdictImage::kOutside) {
            piece.enclosed = false;
        } else if (!may_be_hole(verdicts_[cell])) {
            if (verdicts_[cell] != CellVerdict::support) piece.enclosed = false;
        } else if (!visited_[cell]) {
            visited_[cell] = true;
            piece.cells.push_back(cell);
        }
    }
    bool is_hole(const Piece& piece) const {
        const auto seen = static_cast<std::size_t>(
            std::count_if(piece.cells.begin(), piece.cells.end(),
                          [&](std::size_t cell) { return through_[cell]; }));
        return piece.enclosed && seen >= kMinThrough &&
               static_cast<double>(seen) >=
                   kMinThroughShare * static_cast<double>(piece.cells.size());
    }
    bool blank(std::size_t cell) const {
        return cell != VerdictImage::kOutside &&
               (through_[cell] || verdicts_[cell] == CellVerdict::missing);
    }
    std::size_t inside(const Piece& piece) const {
        return static_cast<std::size_t>(
            std::count_if(piece.cells.begin(), piece.cells.end(), [&](std::size_t cell) {
                return blank(cell) &&
                       std::all_of(kSides.begin(), kSides.end(),
                                   [&](const auto& side) { return blank(beside(cell, side)); });
            }));
    }

    const VerdictImage& image_;
    std::span<const std::uint32_t> window_;
    std::span<const CellVerdict> verdicts_;
    const std::vector<bool>& through_;
    std::vector<bool> visited_;
};

}  // namespace

std::size_t solid_contradiction(const RangeMap& ranges, std::span<const std::uint32_t> window,
                                std::span<const CellVerdict> verdicts) {
    return inside_pieces(ranges, window, verdicts, contradicts);
}

std::size_t solid_blank(const RangeMap& ranges, std::span<const std::uint32_t> window,
                        std::span<const CellVerdict> verdicts) {
    return inside_pieces(ranges, window, verdicts,
                         [](CellVerdict verdict) { return verdict == CellVerdict::missing; });
}

std::size_t hollow_contradiction(const RangeMap& ranges, std::span<const std::uint32_t> window,
                                 std::span<const CellVerdict> verdicts,
                                 const std::vector<bool>& through) {
    if (window.empty()) return 0;
    const VerdictImage image(ranges, window, verdicts);
    return Holes(image, window, verdicts, through).cells_inside();
}

}  // namespace ostraka
