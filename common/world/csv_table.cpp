#include "common/world/csv_table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
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

std::string_view without_quotes(std::string_view text) {
  return text.size() >= 2 && text.front() == '"' && text.back() == '"' ? text.substr(1, text.size() - 2) : text;
}

/// The next comma from `begin` on that is not in double quotes, or the end of the line. A quote that is never closed
/// quotes nothing.
std::size_t end_of_field(std::string_view line, std::size_t begin) {
  const std::size_t comma = std::min(line.find(',', begin), line.size());
  const std::size_t quote = line.find_first_not_of(" \t", begin);
  if (quote >= comma || line[quote] != '"') return comma;
  const std::size_t closing = line.find('"', quote + 1);
  return closing == std::string_view::npos ? comma : std::min(line.find(',', closing), line.size());
}

/// Takes a number of this many digits, and the character after it unless that is 0, from the beginning of `text`.
std::optional<int> take_number(std::string_view& text, std::size_t digits, char after) {
  const std::size_t size = digits + (after != 0 ? 1 : 0);
  const std::string_view number = text.substr(0, digits);
  if (text.size() < size || (after != 0 && text[digits] != after) ||
      !std::ranges::all_of(number, [](char c) { return c >= '0' && c <= '9'; }))
    return std::nullopt;
  text.remove_prefix(size);
  return number_in<int>(number);
}

/// Seconds of "", "Z" or "+02:00".
std::optional<double> seconds_of_zone(std::string_view zone) {
  if (zone.empty() || zone == "Z") return 0.0;
  const double sign = zone.front() == '-' ? -1.0 : 1.0;
  if (zone.front() != '+' && zone.front() != '-') return std::nullopt;
  zone.remove_prefix(1);
  const auto hours = take_number(zone, 2, ':');
  const auto minutes = take_number(zone, 2, 0);
  if (!hours || !minutes || !zone.empty()) return std::nullopt;
  return sign * (3600.0 * *hours + 60.0 * *minutes);
}

}  // namespace

std::optional<double> seconds_of_date(std::string_view text) {
  const char between = text.size() > 10 && text[10] == ' ' ? ' ' : 'T';
  const auto year = take_number(text, 4, '-');
  const auto month = take_number(text, 2, '-');
  const auto day = take_number(text, 2, between);
  const auto hour = take_number(text, 2, ':');
  const auto minute = take_number(text, 2, ':');
  const auto seconds = number_in<double>(text.substr(0, text.find_first_of("Z+-")));
  if (!year || !month || !day || !hour || !minute || !seconds) return std::nullopt;
  const auto zone = seconds_of_zone(text.substr(std::min(text.find_first_of("Z+-"), text.size())));
  const std::chrono::year_month_day date{std::chrono::year(*year), std::chrono::month(static_cast<unsigned>(*month)),
                                         std::chrono::day(static_cast<unsigned>(*day))};
  if (!date.ok() || *hour > 23 || *minute > 59 || !(*seconds >= 0.0 && *seconds <= 60.0) || !zone) return std::nullopt;
  const auto days = std::chrono::sys_days(date).time_since_epoch().count();
  return 86'400.0 * static_cast<double>(days) + 3600.0 * *hour + 60.0 * *minute + *seconds - *zone;
}

CsvReader::CsvReader(std::string_view csv, std::string_view name, std::span<const CsvColumn> columns,
                     std::string_view rows, OtherColumns others)
    : rest_(csv), name_(name), columns_(columns), rows_(rows), others_(others) {
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
    if (at == names.end() && others_ == OtherColumns::ignored) {
      order_.push_back(ignored);
      continue;
    }
    if (at == names.end())
      fail_at(line_, field.place,
              fmt::format("unknown column '{}' in the header.{} Allowed: {}", excerpt(field.text),
                          did_you_mean(field.text, names), fmt::join(names, ", ")));
    const auto index = static_cast<std::size_t>(at - names.begin());
    if (has(index)) fail_at(line_, field.place, fmt::format("column '{}' stands twice in the header", field.text));
    order_.push_back(index);
  }
  for (std::size_t i = 0; i < columns_.size(); ++i)
    if (columns_[i].required && !has(i)) fail_missing(columns_[i].name);
}

void CsvReader::fail_missing(const std::string& column) const {
  std::vector<std::string> found;
  std::ranges::transform(fields_, std::back_inserter(found), [](const Field& field) { return excerpt(field.text); });
  fail_at(line_, 1,
          others_ == OtherColumns::refused
              ? fmt::format("the header has no column '{}', which is required", column)
              : fmt::format("the header has no column '{}', which is required.{} It has {}", excerpt(column),
                            did_you_mean(column, found), fmt::join(found, ", ")));
}

bool CsvReader::next_row(std::span<double> values, std::span<std::uint32_t> places, std::size_t& line) {
  const auto text = next_line();
  if (!text) return false;
  split(*text);
  if (fields_.size() != order_.size())
    fail_at(line_, fields_.size() > order_.size() ? fields_[order_.size()].place : text->size() + 1,
            fmt::format("{} fields, but the header has {}", fields_.size(), order_.size()));
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    if (order_[i] == ignored) continue;
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
    const std::size_t end = end_of_field(line, begin);
    fields_.push_back({without_quotes(without_blanks(line.substr(begin, end - begin))), begin + 1});
    if (end == line.size()) return;
    begin = end + 1;
  }
}

double CsvReader::number(const Field& field, const CsvColumn& column) const {
  std::optional<double> given = number_in<double>(field.text);
  if (!given && column.time) given = seconds_of_date(field.text);
  const double value = given.value_or(std::nan(""));
  if (!(value >= column.minimum && value <= column.maximum) || (column.whole && value != std::floor(value)))
    fail_at(line_, field.place,
            fmt::format("{} is '{}'; use a {} from {} to {}{}", column.name, excerpt(field.text),
                        column.whole ? "whole number" : "number", column.minimum, column.maximum,
                        column.time ? ", or a date and time such as 2026-05-01T12:00:00.5Z" : ""));
  return value;
}

void CsvReader::fail_at(std::size_t line, std::size_t place, const std::string& reason) const {
  throw InputError("{}:{}:{}: {}", name_, line, place, reason);
}

void CsvReader::fail_empty() const {
  fail_at(line_ + 1, 1, fmt::format("no rows after the header; {} is needed", rows_));
}

}  // namespace aloft::world
