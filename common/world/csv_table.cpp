#include "common/world/csv_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "common/base/nearest.hpp"
#include "common/base/number_text.hpp"
#include "common/base/plain_text.hpp"

namespace aloft::world {
namespace {

std::string_view without_blanks(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  return first == std::string_view::npos ? std::string_view{}
                                         : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

}  // namespace

CsvReader::CsvReader(std::string_view csv, std::string_view name, std::span<const CsvColumn> columns,
                     std::string_view rows)
    : rest_(csv), name_(name), columns_(columns), rows_(rows) {
  if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
}

bool CsvReader::has(std::size_t column) const {
  return std::ranges::find(order_, column) != order_.end();
}

void CsvReader::read_header() {
  std::vector<std::string> names(columns_.size());
  std::ranges::transform(columns_, names.begin(), [](const CsvColumn& column) { return column.name; });
  const auto line = next_line();
  if (!line) fail_at(1, 1, fmt::format("the file is empty; it must begin with a header of {}", fmt::join(names, ", ")));
  split(*line);
  for (const Field& field : fields_) {
    const auto at = std::ranges::find(names, field.text);
    if (at == names.end())
      fail_at(line_, field.place,
              fmt::format("unknown column '{}' in the header.{} Allowed: {}", excerpt(field.text),
                          did_you_mean(field.text, names), fmt::join(names, ", ")));
    const auto index = static_cast<std::size_t>(at - names.begin());
    if (has(index)) fail_at(line_, field.place, fmt::format("column '{}' stands twice in the header", field.text));
    order_.push_back(index);
  }
  for (std::size_t i = 0; i < columns_.size(); ++i)
    if (columns_[i].required && !has(i))
      fail_at(line_, 1, fmt::format("the header has no column '{}', which is required", columns_[i].name));
}

bool CsvReader::next_row(std::span<double> values, std::span<std::uint32_t> places, std::size_t& line) {
  const auto text = next_line();
  if (!text) return false;
  split(*text);
  if (fields_.size() != order_.size())
    fail_at(line_, fields_.size() > order_.size() ? fields_[order_.size()].place : text->size() + 1,
            fmt::format("{} fields, but the header has {}", fields_.size(), order_.size()));
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    values[order_[i]] = number(fields_[i], columns_[order_[i]]);
    places[order_[i]] = static_cast<std::uint32_t>(fields_[i].place);
  }
  line = line_;
  return true;
}

std::optional<std::string_view> CsvReader::next_line() {
  while (!rest_.empty()) {
    const std::size_t end = std::min(rest_.find('\n'), rest_.size());
    const std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    ++line_;
    if (!without_blanks(line).empty()) return line;
  }
  return std::nullopt;
}

void CsvReader::split(std::string_view line) {
  fields_.clear();
  std::size_t begin = 0;
  while (true) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    fields_.push_back({without_blanks(line.substr(begin, end - begin)), begin + 1});
    if (end == line.size()) return;
    begin = end + 1;
  }
}

double CsvReader::number(const Field& field, const CsvColumn& column) const {
  const double value = number_in<double>(field.text).value_or(std::nan(""));
  if (!(value >= column.minimum && value <= column.maximum) || (column.whole && value != std::floor(value)))
    fail_at(line_, field.place,
            fmt::format("{} is '{}'; use a {} from {} to {}", column.name, excerpt(field.text),
                        column.whole ? "whole number" : "number", column.minimum, column.maximum));
  return value;
}

void CsvReader::fail_at(std::size_t line, std::size_t place, const std::string& reason) const {
  throw InputError("{}:{}:{}: {}", name_, line, place, reason);
}

void CsvReader::fail_empty() const {
  fail_at(line_ + 1, 1, fmt::format("no rows after the header; {} is needed", rows_));
}

}  // namespace aloft::world
