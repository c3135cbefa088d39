#include "common/base/text_layout.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <locale.h>
#include <wchar.h>

#include <algorithm>

namespace aloft {
namespace {

constexpr std::string_view indent = "  ";
constexpr std::string_view gap = "  ";
constexpr std::size_t narrowest_name = 12;  // the first column is never cut below this

/// The characters of a text and the columns that they take, by the C library's UTF-8 table, independent of the
/// program's locale.
class Characters {
 public:
  explicit Characters(std::string_view text) : rest_(text), before_(uselocale(utf8())) {}
  ~Characters() { uselocale(before_); }
  Characters(const Characters&) = delete;
  Characters& operator=(const Characters&) = delete;

  struct One {
    std::size_t bytes = 0;
    std::size_t columns = 0;
  };
  /// The next character; without bytes at the end.
  One next() {
    if (rest_.empty()) return {};
    wchar_t character = 0;
    mbstate_t state{};
    const std::size_t bytes = mbrtowc(&character, rest_.data(), rest_.size(), &state);
    const bool valid = bytes > 0 && bytes <= rest_.size();
    const int columns = valid ? wcwidth(character) : 1;
    const One one{valid ? bytes : 1, columns < 0 ? 1U : static_cast<std::size_t>(columns)};
    rest_.remove_prefix(one.bytes);
    return one;
  }

 private:
  static locale_t utf8() {
    static const locale_t locale = newlocale(LC_CTYPE_MASK, "C.UTF-8", locale_t{});
    return locale;  // null if the C library has no C.UTF-8: then the thread keeps its locale
  }

  std::string_view rest_;
  locale_t before_;
};

std::string padded(const std::string& text, std::size_t width, bool left, bool bold) {
  const std::string space(width - std::min(width, display_width(text)), ' ');
  const std::string shown = bold ? fmt::format("\033[1m{}\033[0m", text) : text;
  return left ? shown + space : space + shown;
}

std::string markdown_cell(std::string text, bool emphasised) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, 1, '\\');
  return emphasised ? "**" + text + "**" : text;
}

}  // namespace

std::size_t display_width(std::string_view line) {
  std::size_t width = 0;
  Characters characters(line);
  for (auto one = characters.next(); one.bytes > 0; one = characters.next()) width += one.columns;
  return width;
}

std::string cut_to(std::string_view line, std::size_t width) {
  if (display_width(line) <= width) return std::string(line);
  if (width == 0) return {};
  std::size_t bytes = 0;
  std::size_t columns = 1;  // the mark's
  Characters characters(line);
  for (auto one = characters.next(); one.bytes > 0 && columns + one.columns <= width; one = characters.next()) {
    bytes += one.bytes;
    columns += one.columns;
  }
  return std::string(line.substr(0, bytes)) + "…";
}

std::string wrapped(std::string_view text, std::size_t width, std::string_view first, std::string_view rest) {
  std::string lines;
  std::string line(first);
  std::size_t columns = display_width(first);
  bool empty = true;
  std::size_t spaces = 0;  // before the next word; none at a line's begin
  const auto end_line = [&] {
    lines += line + '\n';
    line = rest;
    columns = display_width(rest);
    empty = true;
    spaces = 0;
  };
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of(" \n"), text.size());
    const std::string_view word = text.substr(0, end);
    if (!word.empty()) {
      const std::size_t word_columns = display_width(word);
      if (!empty && columns + spaces + word_columns > width) end_line();
      line += std::string(spaces, ' ') + std::string(word);
      columns += spaces + word_columns;
      spaces = 0;
      empty = false;
    }
    if (end < text.size() && text[end] == ' ' && !empty) ++spaces;
    if (end < text.size() && text[end] == '\n') end_line();
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  if (!empty || lines.empty()) lines += line + '\n';
  return lines;
}

std::vector<std::size_t> TextTable::widths() const {
  std::vector<std::size_t> widths;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    widths.push_back(display_width(columns_[i].heading));
    for (const std::vector<Cell>& row : rows_) widths[i] = std::max(widths[i], display_width(row.at(i).text));
  }
  return widths;
}

unsigned TextTable::fitting_rank(const TableShape& shape) const {
  if (shape.brief) return 0;
  const std::vector<std::size_t> all = widths();
  std::vector<unsigned> ranks(columns_.size());
  std::ranges::transform(columns_, ranks.begin(), [](const Column& column) { return column.rank; });
  std::sort(ranks.rbegin(), ranks.rend());
  for (const unsigned rank : ranks) {
    std::size_t needed = indent.size();
    for (std::size_t i = 0; i < columns_.size(); ++i)
      if (columns_[i].rank <= rank) needed += all[i] + (i > 0 ? gap.size() : 0);
    if (needed <= shape.width) return rank;
  }
  return 0;
}

std::string TextTable::left_out(unsigned rank, const TableShape& shape) const {
  std::vector<std::string> headings;
  for (const Column& column : columns_)
    if (column.rank > rank) headings.push_back(column.heading);
  if (headings.empty() || shape.brief) return {};
  return wrapped(
      fmt::format("Left out to fit {} columns: {}. --wide shows all.", shape.width, fmt::join(headings, ", ")),
      shape.width);
}

std::string TextTable::block(const std::vector<std::size_t>& shown, const std::vector<std::size_t>& widths,
                             bool bold) const {
  const auto line_of = [&](auto&& cell) {
    std::string line = fmt::format("{}{}", indent, padded(cut_to(cell(0).text, widths[0]), widths[0], true, false));
    for (const std::size_t i : shown)
      if (i > 0) line += std::string(gap) + padded(cell(i).text, widths[i], false, bold && cell(i).emphasised);
    line.erase(line.find_last_not_of(' ') + 1);
    return line + '\n';
  };
  std::string text = line_of([&](std::size_t i) { return Cell(columns_[i].heading); });
  for (const std::vector<Cell>& row : rows_) text += line_of([&](std::size_t i) { return row[i]; });
  return text;
}

std::string TextTable::text(const TableShape& shape, unsigned rank) const {
  std::vector<std::size_t> all = widths();
  std::size_t widest = 0;
  for (std::size_t i = 1; i < columns_.size(); ++i)
    if (columns_[i].rank <= rank) widest = std::max(widest, all[i]);
  const std::size_t for_others = indent.size() + gap.size() + widest;
  all[0] = std::min(all[0], std::max(narrowest_name, shape.width - std::min(shape.width, for_others)));
  std::string text;
  std::vector<std::size_t> shown{0};
  std::size_t used = indent.size() + all[0];
  for (std::size_t i = 1; i < columns_.size(); ++i) {
    if (columns_[i].rank > rank) continue;
    if (shown.size() > 1 && used + gap.size() + all[i] > shape.width) {
      text += block(shown, all, shape.bold) + '\n';
      shown = {0};
      used = indent.size() + all[0];
    }
    shown.push_back(i);
    used += gap.size() + all[i];
  }
  return text + block(shown, all, shape.bold);
}

std::string TextTable::markdown() const {
  std::string text = "|";
  for (const Column& column : columns_) text += fmt::format(" {} |", markdown_cell(column.heading, false));
  text += "\n|";
  for (std::size_t i = 0; i < columns_.size(); ++i) text += "---|";
  for (const std::vector<Cell>& row : rows_) {
    text += "\n|";
    for (const Cell& cell : row) text += fmt::format(" {} |", markdown_cell(cell.text, cell.emphasised));
  }
  return text + '\n';
}

}  // namespace aloft
