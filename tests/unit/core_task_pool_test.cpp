#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <limits>
#include <numeric>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include "engine/core/task_pool.h"

namespace hl {
namespace {

TEST(TaskPool, EachIndexOnceWhateverTheGrain) {
  TaskPool pool(4);
  for (size_t count : {size_t{1}, size_t{7}, size_t{1000}}) {
    for (size_t grain : {size_t{0}, size_t{1}, size_t{3}, size_t{64}, std::numeric_limits<size_t>::max()}) {
      std::vector<int> visits(count, 0);  // plain ints: two workers in one piece would be a race
      pool.parallelFor(count, grain, [&](size_t begin, size_t end, unsigned worker) {
        EXPECT_LT(worker, pool.threads());
        EXPECT_LT(begin, end);
        EXPECT_LE(end - begin, std::max<size_t>(grain, 1));
        for (size_t i = begin; i < end; ++i) ++visits[i];
      });
      EXPECT_EQ(visits, std::vector<int>(count, 1)) << count << " in pieces of " << grain;
    }
  }
}

TEST(TaskPool, NothingToDo) {
  TaskPool pool(2);
  pool.parallelFor(0, 1, [](size_t, size_t, unsigned) { FAIL(); });
}

TEST(TaskPool, ResultsOfPiecesAreSeenByTheCaller) {
  TaskPool pool(3);
  std::vector<long> sums(pool.threads(), 0);
  for (int round = 0; round < 200; ++round)
    pool.parallelFor(100, 7, [&](size_t begin, size_t end, unsigned worker) {
      for (size_t i = begin; i < end; ++i) sums[worker] += static_cast<long>(i);
    });
  EXPECT_EQ(std::accumulate(sums.begin(), sums.end(), 0L), 200L * 4950);
}

TEST(TaskPool, WorkersAreNiceAndTheCallerIsNot) {
  const int before = getpriority(PRIO_PROCESS, static_cast<id_t>(gettid()));
  TaskPool pool(2);
  std::atomic<int> wrong{0};
  pool.parallelFor(64, 1, [&](size_t, size_t, unsigned) {
    if (getpriority(PRIO_PROCESS, static_cast<id_t>(gettid())) != 10) ++wrong;
  });
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(getpriority(PRIO_PROCESS, static_cast<id_t>(gettid())), before);
}

TEST(TaskPool, TheCallersThreadOnlyWaits) {
  TaskPool pool(1);
  const auto caller = std::this_thread::get_id();
  pool.parallelFor(8, 1, [&](size_t, size_t, unsigned) { EXPECT_NE(std::this_thread::get_id(), caller); });
}

TEST(TaskPool, AnExceptionComesOutAndTheRestIsNotBegun) {
  TaskPool pool(2);
  for (int round = 0; round < 50; ++round) {
    std::atomic<size_t> begun{0};
    const auto work = [&](size_t begin, size_t, unsigned) {
      ++begun;
      if (begin == 3) throw std::runtime_error("piece 3");
      std::this_thread::sleep_for(std::chrono::microseconds(20));
    };
    try {
      pool.parallelFor(100'000, 1, work);
      FAIL() << "nothing was thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "piece 3");
    }
    EXPECT_LT(begun, 100'000u);
    std::atomic<int> done{0};
    pool.parallelFor(10, 1, [&](size_t, size_t, unsigned) { ++done; });
    EXPECT_EQ(done, 10) << "the pool must go on after a failure";
  }
}

TEST(TaskPool, EveryPieceMayThrow) {
  TaskPool pool(4);
  for (int round = 0; round < 50; ++round)
    EXPECT_THROW(pool.parallelFor(64, 1, [](size_t, size_t, unsigned) { throw std::runtime_error("each"); }),
                 std::runtime_error);
}

TEST(TaskPool, CallersFromSeveralThreadsTakeTurns) {
  TaskPool pool(2);
  std::vector<size_t> totals(4, 0);
  std::vector<std::thread> callers;
  for (size_t& total : totals)
    callers.emplace_back([&pool, &total] {
      for (int round = 0; round < 50; ++round) {
        std::atomic<size_t> sum{0};
        pool.parallelFor(100, 9, [&](size_t begin, size_t end, unsigned) { sum += end - begin; });
        total += sum;
      }
    });
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(totals, std::vector<size_t>(4, 5000));
}

TEST(TaskPool, CallsFromInsideAPieceAreRefused) {
  TaskPool pool(2), other(1);
  std::atomic<int> done{0};
  EXPECT_THROW(pool.parallelFor(
                   1, 1, [&](size_t, size_t, unsigned) { pool.parallelFor(1, 1, [](size_t, size_t, unsigned) {}); }),
               std::logic_error);
  pool.parallelFor(
      1, 1, [&](size_t, size_t, unsigned) { other.parallelFor(5, 1, [&](size_t, size_t, unsigned) { ++done; }); });
  EXPECT_EQ(done, 5);
}

TEST(TaskPool, AsManyWorkersAsTheMachineHasThreads) {
  EXPECT_EQ(TaskPool().threads(), std::max(1u, std::thread::hardware_concurrency()));
}

}  // namespace
}  // namespace hl
