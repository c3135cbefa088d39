#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace aloft::test {

/// The screen of a terminal with a given number of columns. Knows the control sequences that aloft uses: line feed,
/// carriage return, erasing to the end of the row, and typefaces, which it ignores.
class Screen {
 public:
  explicit Screen(std::size_t columns) : columns_(columns) {}

  void write(const std::string& bytes);
  [[nodiscard]] std::vector<std::string> rows() const;
  /// Lines that took more than one row.
  [[nodiscard]] std::vector<std::string> wrapped_lines() const;

 private:
  struct Row {
    std::vector<std::string> cells;
    bool continues = false;
  };
  void put(const std::string& character, std::size_t width);
  /// Length of the sequence at the start in bytes; none if it is not complete yet.
  std::size_t escape_sequence(const std::string& bytes);

  std::size_t columns_;
  std::string incomplete_;
  std::vector<Row> rows_{1};
  std::size_t column_ = 0;
};

/// A program of build/bin in its own terminal, started in the repository's root and ended with the test.
class TerminalSession {
 public:
  TerminalSession(const std::vector<std::string>& arguments, unsigned short columns);
  ~TerminalSession();
  TerminalSession(const TerminalSession&) = delete;
  TerminalSession& operator=(const TerminalSession&) = delete;

  /// Reads output for a moment; false once the program has ended.
  bool listen();
  [[nodiscard]] const Screen& screen() const noexcept { return screen_; }
  [[nodiscard]] const std::string& bytes() const noexcept { return bytes_; }
  /// Waits for the end; -1: ended by a signal. Fails the test if the program does not end in time.
  int wait(std::chrono::seconds limit);

 private:
  Screen screen_;
  std::string bytes_;
  int descriptor_ = -1;
  int pid_ = 0;
};

}  // namespace aloft::test
