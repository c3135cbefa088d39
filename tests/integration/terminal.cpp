#include "tests/integration/terminal.hpp"

#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <catch2/catch.hpp>
#include <stdexcept>

#include "common/base/text_layout.hpp"
#include "tests/integration/command.hpp"
#include "tests/paths.hpp"

namespace aloft::test {
namespace {

/// Bytes of the UTF-8 character that begins with this one.
std::size_t length_of(char first) {
  const auto byte = static_cast<unsigned char>(first);
  return byte >= 0xF0 ? 4 : byte >= 0xE0 ? 3 : byte >= 0xC0 ? 2 : 1;
}

}  // namespace

void Screen::write(const std::string& bytes) {
  std::string rest = std::exchange(incomplete_, "") + bytes;
  while (!rest.empty()) {
    std::size_t used = rest[0] == '\033' ? escape_sequence(rest) : length_of(rest[0]);
    if (used == 0 || used > rest.size()) {
      incomplete_ = rest;
      return;
    }
    const std::string character = rest.substr(0, used);
    if (character == "\n")
      rows_.emplace_back();  // the terminal driver sends a carriage return with it
    else if (character == "\r")
      column_ = 0;
    else if (character[0] != '\033')
      put(character, display_width(character));
    rest.erase(0, used);
  }
}

std::size_t Screen::escape_sequence(const std::string& bytes) {
  const std::size_t end = bytes.find_first_of("KmHJ");
  if (end == std::string::npos) return 0;
  if (bytes[end] == 'K') rows_.back().cells.resize(std::min(rows_.back().cells.size(), column_));
  return end + 1;
}

void Screen::put(const std::string& character, std::size_t width) {
  if (column_ + width > columns_) {
    rows_.push_back({{}, true});
    column_ = 0;
  }
  std::vector<std::string>& cells = rows_.back().cells;
  if (width == 0 && column_ > 0) {
    cells[column_ - 1] += character;
    return;
  }
  cells.resize(std::max(cells.size(), column_ + width));
  cells[column_] = character;
  column_ += width;
}

std::vector<std::string> Screen::rows() const {
  std::vector<std::string> texts;
  for (const Row& row : rows_) {
    texts.emplace_back();
    for (const std::string& cell : row.cells) texts.back() += cell;
  }
  return texts;
}

std::vector<std::string> Screen::wrapped_lines() const {
  const std::vector<std::string> texts = rows();
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (!rows_[i].continues) continue;
    if (rows_[i - 1].continues)
      lines.back() += texts[i];
    else
      lines.push_back(texts[i - 1] + texts[i]);
  }
  return lines;
}

TerminalSession::TerminalSession(const std::vector<std::string>& arguments, unsigned short columns) : screen_(columns) {
  const int test = getpid();
  const winsize size{24, columns, 0, 0};
  pid_ = forkpty(&descriptor_, nullptr, nullptr, &size);
  if (pid_ < 0) throw std::runtime_error("cannot make a terminal");
  if (pid_ > 0) return;
  die_with(test);
  unsetenv("COLUMNS");
  if (chdir(source_dir().c_str()) != 0) _exit(126);
  std::vector<std::string> copies = arguments;
  if (!copies[0].starts_with('/')) copies[0] = bin_dir() / copies[0];
  std::vector<char*> argv;
  for (std::string& argument : copies) argv.push_back(argument.data());
  argv.push_back(nullptr);
  execv(argv[0], argv.data());
  _exit(127);
}

TerminalSession::~TerminalSession() {
  if (pid_ > 0) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  close(descriptor_);
}

bool TerminalSession::listen() {
  pollfd ready{descriptor_, POLLIN, 0};
  if (poll(&ready, 1, 50) <= 0) return true;
  std::array<char, 4096> buffer;
  const ssize_t count = read(descriptor_, buffer.data(), buffer.size());
  if (count <= 0) return false;  // EIO: no process has the terminal open any more
  const std::string bytes(buffer.data(), static_cast<std::size_t>(count));
  bytes_ += bytes;
  screen_.write(bytes);
  return true;
}

int TerminalSession::wait(std::chrono::seconds limit) {
  const auto deadline = std::chrono::steady_clock::now() + limit * slowdown;
  while (listen())
    if (std::chrono::steady_clock::now() > deadline) FAIL("still running; its terminal: " << bytes_);
  int status = 0;
  waitpid(std::exchange(pid_, 0), &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace aloft::test
