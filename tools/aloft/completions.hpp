#pragma once

#include "tools/aloft/commands.hpp"

namespace aloft::cli {

/// Adds the command that prints what a shell needs to complete the words of all commands of `app`.
void add_completions(CLI::App& app, Job& job);

}  // namespace aloft::cli
