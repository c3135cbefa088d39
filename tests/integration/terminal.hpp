#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace aloft::test {

/// What a terminal of so many columns shows of what programs write to it. Knows what aloft uses: line feed, carriage
/// return, erasing to the end of the row, and typefaces, which it passes over.
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
  /// Bytes that the sequence at the start takes; none: it is not complete yet.
  std::size_t escape_sequence(const std::string& bytes);

  std::size_t columns_;
  std::string incomplete_;
  std::vector<Row> rows_{1};
  std::size_t column_ = 0;
};

/// A program of build/bin in a terminal of its own, started in the repository's root. It does not survive the test.
class TerminalSession {
 public:
  TerminalSession(const std::vector<std::string>& arguments, unsigned short columns);
  ~TerminalSession();
  TerminalSession(const TerminalSession&) = delete;
  TerminalSession& operator=(const TerminalSession&) = delete;

  /// Reads what comes for a moment; false once the program has ended.
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
