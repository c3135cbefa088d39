#pragma once

#include <optional>

#include "common/agents/site_map.hpp"
#include "common/agents/state_archive.hpp"

namespace aloft::agents {

/// What an agent keeps of the site map of its flight.
struct SiteSurvey {
  Parameters radio;
  world::SiteMap map;
};

/// From the first site map of a flight. std::logic_error if it is an update.
[[nodiscard]] SiteSurvey survey_from(const SiteMap& first);

void save_survey(StateWriter& writer, const std::optional<SiteSurvey>& survey);
[[nodiscard]] std::optional<SiteSurvey> restore_survey(const StateReader& reader);

}  // namespace aloft::agents
