#pragma once

#include "common/bus/endpoint.hpp"
#include "services/status/run_view.hpp"

namespace aloft::status {

/// Listens to one run; only reads. One thread at a time.
class RunObserver {
 public:
  explicit RunObserver(const bus::BusOptions& place);

  /// Takes what has arrived. Never waits.
  void listen();
  [[nodiscard]] const bus::Participant& participant() const noexcept { return participant_; }
  [[nodiscard]] const RunView& view() const noexcept { return view_; }

 private:
  bus::Participant participant_;
  bus::Reader<wire::RunControl> controls_{participant_};
  bus::Reader<wire::RunStatus> runs_{participant_};
  bus::Reader<wire::WorkerStatus> workers_{participant_};
  bus::Reader<wire::CollectorStatus> collectors_{participant_};
  RunView view_;
};

}  // namespace aloft::status
