#include "common/bus/reunion.hpp"

#include <catch2/catch.hpp>

using aloft::bus::Reunion;
using Kind = Reunion::Kind;
using namespace std::chrono_literals;

namespace {

Reunion::Process process(std::uint8_t number) {
  Reunion::Process result;
  result.value[0] = number;
  return result;
}

Reunion::Endpoint endpoint(std::uint8_t of_process, std::uint8_t number) {
  Reunion::Endpoint result;
  result.guidPrefix = process(of_process);
  result.entityId.value[2] = number;
  return result;
}

const Reunion::Process self = process(1);
const Reunion::Process other = process(2);
const Reunion::Process third = process(3);
const Reunion::Clock::time_point start{};

/// Knows the other's writer and reader.
struct Scene {
  Reunion reunion;
  Scene() {
    reunion.heard(other, "other", start);
    reunion.found(endpoint(2, 1), Kind::writer);
    reunion.found(endpoint(2, 2), Kind::reader);
  }
  /// Forgotten and heard again at `start`.
  void lose() {
    reunion.removed(endpoint(2, 2), Kind::reader);
    reunion.removed(endpoint(2, 1), Kind::writer);
    reunion.fell_silent(other, start);
    reunion.heard(other, "other", start);
  }
};

}  // namespace

TEST_CASE("who was never forgotten, or comes back with all its endpoints, is not asked") {
  Scene scene;
  CHECK_FALSE(scene.reunion.waits());
  CHECK_FALSE(scene.reunion.question(start + 1h));
  scene.lose();
  CHECK(scene.reunion.waits());
  CHECK_FALSE(scene.reunion.question(start + 100ms));
  scene.reunion.found(endpoint(2, 1), Kind::writer);
  scene.reunion.found(endpoint(2, 2), Kind::reader);
  CHECK_FALSE(scene.reunion.question(start + 600ms));
  CHECK_FALSE(scene.reunion.waits());
}

TEST_CASE("who is back without its readers is asked, again and again, ever more rarely, until they are there") {
  Scene scene;
  scene.lose();
  scene.reunion.found(endpoint(2, 1), Kind::writer);
  const auto first = scene.reunion.question(start + 500ms);
  REQUIRE(first);
  CHECK_FALSE(scene.reunion.question(start + 1400ms));
  const auto second = scene.reunion.question(start + 1500ms);
  REQUIRE(second);
  CHECK_FALSE(scene.reunion.question(start + 3400ms));

  Reunion asked;
  CHECK(asked.asks(self, *first, other));
  CHECK_FALSE(asked.asks(self, *first, other));  // the same one, told again
  CHECK(asked.asks(self, *second, other));
  CHECK_FALSE(asked.asks(self, *second, third));  // not meant
  CHECK(asked.asks(third, *second, other));       // asks too

  scene.reunion.found(endpoint(2, 2), Kind::reader);
  CHECK_FALSE(scene.reunion.question(start + 1h));
  CHECK_FALSE(scene.reunion.waits());
}

TEST_CASE("a question to one still holds the open question to another") {
  Scene scene;
  scene.reunion.found(endpoint(3, 1), Kind::writer);
  scene.lose();
  scene.reunion.fell_silent(third, start);
  REQUIRE(scene.reunion.question(start + 500ms));
  scene.reunion.heard(third, "third", start + 600ms);
  const auto question = scene.reunion.question(start + 1200ms);
  REQUIRE(question);
  CHECK(Reunion().asks(self, *question, other));
  CHECK(Reunion().asks(self, *question, third));
}

TEST_CASE("who leaves, or never answers, is not asked for ever") {
  Scene scene;
  scene.lose();
  SECTION("leaves") {
    REQUIRE(scene.reunion.question(start + 500ms));
    scene.reunion.left(other);
    CHECK_FALSE(scene.reunion.question(start + 1h));
  }
  SECTION("never answers") {
    int times = 0;
    for (auto now = start; now < start + 1h; now += 100ms) times += scene.reunion.question(now) ? 1 : 0;
    CHECK(times == 8);
  }
  CHECK_FALSE(scene.reunion.waits());
}

TEST_CASE("user data of others is no question") {
  Reunion reunion;
  CHECK_FALSE(reunion.asks(other, {}, self));
  CHECK_FALSE(reunion.asks(other, {'h', 'i'}, self));
  Scene scene;
  scene.lose();
  auto cut = *scene.reunion.question(start + 500ms);
  cut.pop_back();
  CHECK_FALSE(reunion.asks(process(9), cut, other));
}

TEST_CASE("absent is who is silent for a short time and not replaced, or back a moment ago") {
  using Names = std::vector<std::string>;
  Scene scene;
  CHECK(scene.reunion.absent(10s, start).empty());
  scene.reunion.fell_silent(other, start);
  CHECK(scene.reunion.absent(10s, start + 9s) == Names{"other"});
  CHECK(scene.reunion.absent(10s, start + 10s).empty());
  SECTION("back") {
    scene.reunion.heard(other, "other", start + 1s);
    CHECK(scene.reunion.absent(10s, start + 2s) == Names{"other"});  // its lists may still come
    scene.reunion.found(endpoint(2, 1), Kind::writer);
    scene.reunion.found(endpoint(2, 2), Kind::reader);
    CHECK_FALSE(scene.reunion.question(start + 1500ms));
    CHECK(scene.reunion.absent(10s, start + 2s).empty());
  }
  SECTION("replaced, before or after its silence was noticed") {
    scene.reunion.heard(third, "other", start + 1s);
    CHECK(scene.reunion.absent(10s, start + 2s).empty());
    scene.reunion.fell_silent(third, start + 3s);
    CHECK(scene.reunion.absent(10s, start + 4s) == Names{"other", "other"});
  }
  SECTION("left") {
    scene.reunion.left(other);
    CHECK(scene.reunion.absent(10s, start + 1s).empty());
  }
}
