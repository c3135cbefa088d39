#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/error.hpp"

namespace aloft::world {

/// A column that a CSV file may have. All are numbers.
struct CsvColumn {
  const char* name;
  bool required;
  double minimum;  ///< inclusive range
  double maximum;
  bool whole;
  bool time = false;  ///< seconds; can also be a date and time (ISO 8601)
};

/// What to do about columns that have no CsvColumn.
enum class OtherColumns { refused, ignored };

/// Seconds since 1970 of "2026-05-01T12:00:00.5Z", with a blank for the T, and with "+02:00" or nothing for the Z;
/// nullopt if the text is none such.
[[nodiscard]] std::optional<double> seconds_of_date(std::string_view text);

/// One row: its values, by the index of their columns; 0 where the file has no such column.
template <std::size_t columns>
struct CsvRow {
  std::array<double, columns> value{};
  std::array<std::uint32_t, columns> place{};  ///< of each value in its line: characters from 1
  std::size_t line = 0;
};

/// Reads CSV text: a header that names the columns in any order, then rows of numbers. Blank lines are skipped, and a
/// field can stand in double quotes. Throws InputError "name:line:column: reason", where column counts characters
/// from 1.
class CsvReader {
 public:
  /// `name` is the file's in messages; `rows` says what they stand for: "one row per base station". All must outlive
  /// the reader.
  CsvReader(std::string_view csv, std::string_view name, std::span<const CsvColumn> columns, std::string_view rows,
            OtherColumns others = OtherColumns::refused);

  /// All rows: at least one.
  template <std::size_t columns>
  [[nodiscard]] std::vector<CsvRow<columns>> read() {
    read_header();
    std::vector<CsvRow<columns>> rows;
    for (CsvRow<columns> row; next_row(row.value, row.place, row.line);) rows.push_back(row);
    if (rows.empty()) fail_empty();
    return rows;
  }

  /// Whether the header names this column.
  [[nodiscard]] bool has(std::size_t column) const;

  /// Refuses a value of a row.
  template <std::size_t columns>
  [[noreturn]] void fail(const CsvRow<columns>& row, std::size_t column, const std::string& reason) const {
    fail_at(row.line, row.place.at(column), reason);
  }

 private:
  struct Field {
    std::string_view text;
    std::size_t place;
  };
  static constexpr std::size_t ignored = SIZE_MAX;  // in order_

  void read_header();
  bool next_row(std::span<double> values, std::span<std::uint32_t> places, std::size_t& line);
  /// The next line that is not blank.
  std::optional<std::string_view> next_line();
  void split(std::string_view line);
  [[nodiscard]] double number(const Field& field, const CsvColumn& column) const;
  [[noreturn]] void fail_at(std::size_t line, std::size_t place, const std::string& reason) const;
  [[noreturn]] void fail_empty() const;
  [[noreturn]] void fail_missing(const std::string& column) const;

  std::string_view rest_;
  std::string_view name_;
  std::span<const CsvColumn> columns_;
  std::string_view rows_;
  OtherColumns others_;
  std::size_t line_ = 0;
  std::vector<std::size_t> order_;  // of the columns in the file
  std::vector<Field> fields_;       // of the present line
};

}  // namespace aloft::world
