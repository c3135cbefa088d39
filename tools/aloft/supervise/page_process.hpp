#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "common/bus/participant.hpp"
#include "tools/aloft/supervise/children.hpp"

namespace aloft::cli {

/// What `--live` asks for.
struct PageOptions {
  bool wanted = false;
  bool with_control = false;  ///< --operator: the page can order swaps
};

/// The page of a run on this machine. It is served by a process of its own (aloft live), so that neither its viewers
/// nor its end concern the run; it ends with this object.
class PageProcess {
 public:
  /// Shows the results in `dir` and, if `place` names a run, the run.
  PageProcess(const std::filesystem::path& dir, const bus::BusOptions& place, const PageOptions& options);

  /// What the user should know since the last call: the address, which is also opened on a desktop, or that the page
  /// has ended. Never waits.
  std::vector<std::string> news();
  /// The same once the address is there, or after `limit`.
  std::vector<std::string> first_news(std::chrono::milliseconds limit);

 private:
  std::filesystem::path output_;
  std::uintmax_t already_written_ = 0;  // by pages of earlier runs
  bool told_ = false;
  Children children_;
};

}  // namespace aloft::cli
