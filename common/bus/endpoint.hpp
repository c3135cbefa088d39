#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "common/bus/participant.hpp"
#include "common/bus/topics.hpp"

namespace aloft::bus {

struct WriterOptions {
  std::uint32_t strength = 1;  ///< with exclusive ownership, readers get samples of the strongest live writer
};

/// Publishes one topic. T is a type of idl/; its topic, partition and quality of service come from topics.def.
///
///     bus::Participant participant({.run = "demo", .worker = "w0", .process = "example"});
///     bus::Writer<wire::HeightCommand> commands(participant);
///     commands.write(command);
template <class T>
class Writer {
 public:
  explicit Writer(const Participant& participant, const WriterOptions& options = {});
  Writer(Writer&&) noexcept;
  Writer& operator=(Writer&&) noexcept;
  ~Writer();

  /// Fills in the protocol version and sends. std::invalid_argument if the sample breaks the limits of the wire,
  /// std::runtime_error if the middleware refuses; both name the topic. From one thread at a time.
  void write(T& sample);
  void write(T&& sample) { write(sample); }

  /// Readers known now.
  [[nodiscard]] std::size_t matched() const;
  /// Proves that this writer is alive, on a topic with exclusive ownership; from any thread.
  void assert_liveliness();
  /// Changes WriterOptions::strength, to hand a flight over or to take it over. From any thread.
  void set_strength(std::uint32_t strength);
  /// True once every known reader has everything.
  bool wait_acknowledged(std::chrono::milliseconds limit);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

struct ReaderOptions {
  /// Samples may be lost, and none is acknowledged, so that writers do the least for this reader; many may arrive
  /// between two looks.
  bool looks_on = false;
};

/// Subscribes to one topic. Samples that are malformed, out of range, or of another version or experiment never
/// reach the caller: they are counted and logged.
template <class T>
class Reader {
 public:
  explicit Reader(const Participant& participant, const ReaderOptions& options = {});
  Reader(Reader&&) noexcept;
  Reader& operator=(Reader&&) noexcept;
  ~Reader();

  /// The next sample that arrived; false if there is none. Never waits (see Waiter). `sample` is overwritten.
  bool take(T& sample);
  /// Calls `handle(const T&)` for everything that has arrived.
  template <class Handle>
  void drain(Handle&& handle) {
    while (take(scratch())) handle(std::as_const(scratch()));
  }

  /// From now on, samples of other experiments are dropped.
  void expect_experiment(const std::string& id);
  /// Writers known now.
  [[nodiscard]] std::size_t matched() const;
  [[nodiscard]] Drops drops() const;
  /// The writer of the sample that was taken last: name and address, both unverified, and an id that no two writers
  /// share.
  [[nodiscard]] std::string sender() const;
  /// Counts and logs a sample as invalid that passed the limits, but not the checks of the caller.
  void drop(const char* why);

 private:
  friend class Waiter;
  [[nodiscard]] void* condition();
  [[nodiscard]] T& scratch();

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace aloft::bus
