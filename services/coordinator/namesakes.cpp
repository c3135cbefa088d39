#include "services/coordinator/namesakes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace aloft::coordinator {

Namesakes::Verdict Namesakes::hear(std::string_view worker, const Voice& voice, bool leaves) {
  auto entry = names_.find(worker);
  if (entry == names_.end()) entry = names_.try_emplace(std::string(worker)).first;
  Name& name = entry->second;
  std::erase_if(name.voices, [&](const Voice& other) {
    return other.incarnation == voice.incarnation ? leaves : voice.heard - other.heard > silence;
  });
  if (leaves) {
    if (!name.voices.empty()) return Verdict::other_left;
    names_.erase(entry);
    return Verdict::alone;
  }

  const auto known = std::ranges::find(name.voices, voice.incarnation, &Voice::incarnation);
  const bool speaks_again = known != name.voices.end() && name.last != voice.incarnation;
  if (known == name.voices.end())
    name.voices.push_back(voice);
  else
    known->heard = voice.heard;
  name.last = voice.incarnation;
  const bool was_doubled = name.doubled;
  name.doubled = name.voices.size() > 1 && (was_doubled || speaks_again);
  if (!name.doubled) return Verdict::alone;
  return was_doubled ? Verdict::held_back : Verdict::doubled;
}

std::string Namesakes::text(Clock::time_point now) const {
  for (const auto& [worker, name] : names_) {
    if (!name.doubled) continue;
    std::vector<std::string> places;
    for (const Voice& voice : name.voices)
      if (now - voice.heard <= silence) places.push_back(fmt::format("on host {} (process {})", voice.host, voice.pid));
    if (places.size() > 1)
      return fmt::format("{} workers are called {}: {}; none of them gets trials until the others end", places.size(),
                         worker, fmt::join(places, " and "));
  }
  return "";
}

}  // namespace aloft::coordinator
