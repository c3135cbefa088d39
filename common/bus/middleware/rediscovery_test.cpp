#include "common/bus/middleware/rediscovery.hpp"

#include <catch2/catch.hpp>
#include <future>

using aloft::bus::Rediscovery;
using Kind = Rediscovery::Kind;
using namespace std::chrono_literals;

namespace {

Rediscovery::Process process(std::uint8_t number) {
  Rediscovery::Process result;
  result.value[0] = number;
  return result;
}

Rediscovery::Endpoint endpoint(std::uint8_t of_process, std::uint8_t number) {
  Rediscovery::Endpoint result;
  result.guidPrefix = process(of_process);
  result.entityId.value[2] = number;
  return result;
}

const Rediscovery::Process self = process(1);
const Rediscovery::Process other = process(2);
const Rediscovery::Process third = process(3);
const Rediscovery::Clock::time_point start{};

/// A process that knows the writer and the reader of another.
struct Scene {
  Rediscovery rediscovery;
  Scene() {
    rediscovery.heard(other, "other", start);
    rediscovery.found(endpoint(2, 1), Kind::writer);
    rediscovery.found(endpoint(2, 2), Kind::reader);
  }
  /// Forgotten and heard again at `start`.
  void lose() {
    rediscovery.removed(endpoint(2, 2), Kind::reader);
    rediscovery.removed(endpoint(2, 1), Kind::writer);
    rediscovery.fell_silent(other, start);
    rediscovery.heard(other, "other", start);
  }
};

}  // namespace

TEST_CASE("a peer that was never forgotten, or is back with all its endpoints, is not asked") {
  Scene scene;
  CHECK_FALSE(scene.rediscovery.waits());
  CHECK_FALSE(scene.rediscovery.question(start + 1h));
  scene.lose();
  CHECK(scene.rediscovery.waits());
  CHECK_FALSE(scene.rediscovery.question(start + 100ms));
  scene.rediscovery.found(endpoint(2, 1), Kind::writer);
  scene.rediscovery.found(endpoint(2, 2), Kind::reader);
  CHECK_FALSE(scene.rediscovery.question(start + 600ms));
  CHECK_FALSE(scene.rediscovery.waits());
}

TEST_CASE("a peer that is back without its readers is asked at growing intervals until they are known") {
  Scene scene;
  scene.lose();
  scene.rediscovery.found(endpoint(2, 1), Kind::writer);
  const auto first = scene.rediscovery.question(start + 500ms);
  REQUIRE(first);
  CHECK_FALSE(scene.rediscovery.question(start + 1400ms));
  const auto second = scene.rediscovery.question(start + 1500ms);
  REQUIRE(second);
  CHECK_FALSE(scene.rediscovery.question(start + 3400ms));

  Rediscovery asked;
  CHECK(asked.asks(self, *first, other));
  CHECK_FALSE(asked.asks(self, *first, other));  // the same question again
  CHECK(asked.asks(self, *second, other));
  CHECK_FALSE(asked.asks(self, *second, third));  // to another process
  CHECK(asked.asks(third, *second, other));       // from another process

  scene.rediscovery.found(endpoint(2, 2), Kind::reader);
  CHECK_FALSE(scene.rediscovery.question(start + 1h));
  CHECK_FALSE(scene.rediscovery.waits());
}

TEST_CASE("a question to one still holds the open question to another") {
  Scene scene;
  scene.rediscovery.found(endpoint(3, 1), Kind::writer);
  scene.lose();
  scene.rediscovery.fell_silent(third, start);
  REQUIRE(scene.rediscovery.question(start + 500ms));
  scene.rediscovery.heard(third, "third", start + 600ms);
  const auto question = scene.rediscovery.question(start + 1200ms);
  REQUIRE(question);
  CHECK(Rediscovery().asks(self, *question, other));
  CHECK(Rediscovery().asks(self, *question, third));
}

TEST_CASE("a peer that leaves, or never answers, is not asked without end") {
  Scene scene;
  scene.lose();
  SECTION("leaves") {
    REQUIRE(scene.rediscovery.question(start + 500ms));
    scene.rediscovery.left(other);
    CHECK_FALSE(scene.rediscovery.question(start + 1h));
  }
  SECTION("never answers") {
    int times = 0;
    for (auto now = start; now < start + 1h; now += 100ms) times += scene.rediscovery.question(now) ? 1 : 0;
    CHECK(times == 8);
  }
  CHECK_FALSE(scene.rediscovery.waits());
}

TEST_CASE("user data of others is no question") {
  Rediscovery rediscovery;
  CHECK_FALSE(rediscovery.asks(other, {}, self));
  CHECK_FALSE(rediscovery.asks(other, {'h', 'i'}, self));
  Scene scene;
  scene.lose();
  auto cut = *scene.rediscovery.question(start + 500ms);
  cut.pop_back();
  CHECK_FALSE(rediscovery.asks(process(9), cut, other));
}

TEST_CASE("absent are peers that are silent for a short time and not replaced, or back a moment ago") {
  using Names = std::vector<std::string>;
  Scene scene;
  CHECK(scene.rediscovery.absent(10s, start).empty());
  scene.rediscovery.fell_silent(other, start);
  CHECK(scene.rediscovery.absent(10s, start + 9s) == Names{"other"});
  CHECK(scene.rediscovery.absent(10s, start + 10s).empty());
  SECTION("back") {
    scene.rediscovery.heard(other, "other", start + 1s);
    CHECK(scene.rediscovery.absent(10s, start + 2s) == Names{"other"});  // its lists may still come
    scene.rediscovery.found(endpoint(2, 1), Kind::writer);
    scene.rediscovery.found(endpoint(2, 2), Kind::reader);
    CHECK_FALSE(scene.rediscovery.question(start + 1500ms));
    CHECK(scene.rediscovery.absent(10s, start + 2s).empty());
  }
  SECTION("replaced, before or after its silence was noticed") {
    scene.rediscovery.heard(third, "other", start + 1s);
    CHECK(scene.rediscovery.absent(10s, start + 2s).empty());
    scene.rediscovery.fell_silent(third, start + 3s);
    CHECK(scene.rediscovery.absent(10s, start + 4s) == Names{"other", "other"});
  }
  SECTION("left") {
    scene.rediscovery.left(other);
    CHECK(scene.rediscovery.absent(10s, start + 1s).empty());
    scene.rediscovery.fell_silent(other, start + 2s);  // the end of its lease
    CHECK(scene.rediscovery.absent(10s, start + 2s).empty());
  }
}

// If it fails, it does not return, and ctest's limit ends it.
TEST_CASE("the thread ends while a peer is still to be asked") {
  Rediscovery rediscovery;
  const auto now = Rediscovery::Clock::now();
  rediscovery.heard(other, "other", now);
  rediscovery.found(endpoint(2, 1), Kind::writer);
  rediscovery.fell_silent(other, now);
  rediscovery.heard(other, "other", now);
  REQUIRE(rediscovery.waits());
  std::promise<void> asked;
  aloft::bus::RediscoveryThread thread(
      rediscovery, [&](const Rediscovery::Question&) { asked.set_value(); }, [] {});
  thread.peer_is_back();
  REQUIRE(asked.get_future().wait_for(10s) == std::future_status::ready);
  REQUIRE(rediscovery.waits());  // the next question is due in a second
  thread.end();
}
