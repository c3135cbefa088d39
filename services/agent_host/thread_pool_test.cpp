// What the agent host relies on in Boost.Asio's thread pool.
#include <boost/asio/post.hpp>
#include <boost/asio/thread_pool.hpp>
#include <catch2/catch.hpp>
#include <chrono>
#include <future>
#include <thread>
#include <vector>

using boost::asio::post;
using ThreadPool = boost::asio::thread_pool;
using namespace std::chrono_literals;

namespace {

constexpr auto limit = 30s;  // of every wait: far more than it takes

}  // namespace

TEST_CASE("a long task does not delay another one while a thread is free", "[thread_pool]") {
  std::promise<void> second_is_done;
  std::promise<bool> first_saw_it;
  ThreadPool pool(2);
  post(pool, [&] { first_saw_it.set_value(second_is_done.get_future().wait_for(limit) == std::future_status::ready); });
  post(pool, [&] { second_is_done.set_value(); });
  auto seen = first_saw_it.get_future();
  REQUIRE(seen.wait_for(2 * limit) == std::future_status::ready);
  CHECK(seen.get());
}

TEST_CASE("one thread runs one task at a time, in the order in which they were posted", "[thread_pool]") {
  std::vector<int> order;
  std::promise<void> last;
  ThreadPool pool(1);
  for (int i = 0; i < 100; ++i) post(pool, [&order, i] { order.push_back(i); });
  post(pool, [&] { last.set_value(); });
  REQUIRE(last.get_future().wait_for(limit) == std::future_status::ready);
  for (int i = 0; i < 100; ++i) CHECK(order.at(static_cast<std::size_t>(i)) == i);
}

TEST_CASE("tasks that have not begun are dropped with the pool", "[thread_pool]") {
  std::promise<void> started;
  std::promise<void> go_on;
  bool second = false;
  {
    ThreadPool pool(1);
    post(pool, [&] {
      started.set_value();
      go_on.get_future().wait_for(limit);
    });
    post(pool, [&] { second = true; });
    REQUIRE(started.get_future().wait_for(limit) == std::future_status::ready);
    std::thread([&] { std::this_thread::sleep_for(50ms), go_on.set_value(); }).detach();
  }
  CHECK_FALSE(second);
}
