#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace aloft {

/// The width of an output that is no terminal.
inline constexpr std::size_t unlimited_width = std::numeric_limits<std::size_t>::max();

/// The columns that a line takes in a terminal: wide characters take two, combining ones none, other bytes than
/// UTF-8 one.
[[nodiscard]] std::size_t display_width(std::string_view line);

/// The line; if it takes more than `width` columns, its beginning followed by "…".
[[nodiscard]] std::string cut_to(std::string_view line, std::size_t width);

/// Text broken at spaces into lines of at most `width` columns, each with its line break: the first begins with
/// `first`, the others with `rest`. A longer word has a line of its own; line breaks in the text stay.
[[nodiscard]] std::string wrapped(std::string_view text, std::size_t width, std::string_view first = "",
                                  std::string_view rest = "");

/// How a table is to be printed.
struct TableShape {
  std::size_t width = unlimited_width;  ///< that it should fit
  bool brief = false;                   ///< only the columns that matter most
  bool bold = false;                    ///< emphasised cells in a terminal's bold face
};

/// A table for people: the first column to the left, the others to the right.
class TextTable {
 public:
  struct Column {
    std::string heading;
    unsigned rank = 0;  ///< 0: always shown; columns of the greatest rank are left out first
  };
  struct Cell {
    Cell(std::string cell, bool stands_out = false) : text(std::move(cell)), emphasised(stands_out) {}
    Cell(const char* cell) : text(cell) {}
    std::string text;
    bool emphasised = false;
  };

  explicit TextTable(std::vector<Column> columns) : columns_(std::move(columns)) {}

  /// A cell for every column.
  void add(std::vector<Cell> row) { rows_.push_back(std::move(row)); }

  /// The rank up to which columns are shown: 0 if brief, else the greatest with which all of them fit.
  [[nodiscard]] unsigned fitting_rank(const TableShape& shape) const;
  /// A line that names the columns left out for lack of room; empty if there are none, or if the shape is brief.
  [[nodiscard]] std::string left_out(unsigned rank, const TableShape& shape) const;

  /// Aligned, two spaces from the left, columns up to `rank` only. Columns that still do not fit follow in further
  /// blocks, each of which repeats the first column; that one is cut if necessary.
  [[nodiscard]] std::string text(const TableShape& shape, unsigned rank = every_rank) const;
  [[nodiscard]] std::string markdown() const;

  static constexpr unsigned every_rank = std::numeric_limits<unsigned>::max();

 private:
  [[nodiscard]] std::vector<std::size_t> widths() const;
  [[nodiscard]] std::string block(const std::vector<std::size_t>& shown, const std::vector<std::size_t>& widths,
                                  bool bold) const;

  std::vector<Column> columns_;
  std::vector<std::vector<Cell>> rows_;
};

}  // namespace aloft
