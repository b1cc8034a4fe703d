// The timeline: added spans are written, overlaps are measured, and above its capacity the oldest spans are dropped.
#include "engine/core/timeline.h"

#include <gtest/gtest.h>
#include <json/json.h>

#include <memory>
#include <thread>

namespace rivulet::timeline_test {
namespace {

Json::Value parsed(const std::string& text) {
    Json::Value value;
    std::string errors;
    const std::unique_ptr<Json::CharReader> reader(Json::CharReaderBuilder().newCharReader());
    EXPECT_TRUE(reader->parse(text.data(), text.data() + text.size(), &value, &errors)) << errors;
    return value;
}

TEST(Timeline, ChromesTraceHasEachSpanInItsLane) {
    Timeline timeline;
    timeline.add("cpu", {"cells \"found\"", 10.0, 10.002});
    timeline.add("gl", {"draw", 10.001, 10.004});
    timeline.add("cpu", {"step", 10.005, 10.006});
    const Json::Value events = parsed(timeline.chromeTrace())["traceEvents"];
    ASSERT_EQ(events.size(), 5U) << "two names of lanes, three spans";
    double first = 1, last = 0;
    for (const Json::Value& e : events) {
        if (e["ph"] == "M") continue;
        EXPECT_EQ(e["ph"], "X");
        EXPECT_EQ(e["tid"].asInt(), e["name"] == "draw" ? 2 : 1);
        first = std::min(first, e["ts"].asDouble());
        last = std::max(last, e["ts"].asDouble() + e["dur"].asDouble());
    }
    EXPECT_EQ(first, 0);
    EXPECT_NEAR(last, 6000, 0.01) << "microseconds";
}

TEST(Timeline, AnEmptyOneIsAValidTrace) { EXPECT_TRUE(parsed(Timeline().chromeTrace())["traceEvents"].empty()); }

TEST(Timeline, OverlapCountsCommonTimeOnce) {
    // a: 0-4 in pieces that touch and overlap, and 8-9; b: 1-2, 3-8.5.
    const std::vector<PassSpan> a = {{"", 8, 9}, {"", 0, 2}, {"", 1, 3}, {"", 3, 4}}, b = {{"", 3, 8.5}, {"", 1, 2}};
    EXPECT_DOUBLE_EQ(overlapSeconds(a, b), 1 + 1 + 0.5);
    EXPECT_DOUBLE_EQ(overlapSeconds(b, a), overlapSeconds(a, b));
    EXPECT_EQ(overlapSeconds(a, {}), 0);
}

TEST(Timeline, TheOldestAreForgotten) {
    Timeline timeline(100);
    for (int k = 0; k < 250; ++k) timeline.add("cpu", {"", double(k), k + 0.5});
    const std::vector<PassSpan> kept = timeline.lanes().front().spans;
    // All spans that ended later are stored, and none that ended before.
    const double since = timeline.completeSince();
    EXPECT_EQ(since, kept.front().begin - 0.5);
    EXPECT_LE(kept.size(), 100U);
    EXPECT_GE(kept.size(), 50U);
    EXPECT_EQ(kept.back().begin, 249);
    for (size_t k = 1; k < kept.size(); ++k) EXPECT_EQ(kept[k].begin, kept[k - 1].begin + 1);
    EXPECT_EQ(timeline.lanes(248.2).front().spans.size(), 2U);
}

TEST(Timeline, CompleteSinceIsTheEndOfTheLastDroppedSpan) {
    Timeline timeline(100);
    EXPECT_EQ(timeline.completeSince(), 0);
    // Two lanes, one of which receives spans late and unordered.
    for (int k = 0; k < 100; ++k) timeline.add(k % 2 == 0 ? "cpu" : "gpu", {"", double(k ^ 3), (k ^ 3) + 0.5});
    EXPECT_EQ(timeline.completeSince(), 0);
    timeline.add("cpu", {"", 100, 100.5});
    const double since = timeline.completeSince();
    EXPECT_GT(since, 0);
    std::vector<bool> there(101);
    for (const Timeline::Lane& lane : timeline.lanes(since))
        for (const PassSpan& span : lane.spans) there[static_cast<size_t>(span.begin)] = true;
    for (size_t k = 0; k <= 100; ++k)
        if (static_cast<double>(k) + 0.5 > since) EXPECT_TRUE(there[k]) << k;
}

TEST(Timeline, AfterARestartEarlierSpansAreIgnored) {
    Timeline timeline(10);
    for (int k = 0; k < 20; ++k) timeline.add("cpu", {"", double(k), k + 0.5});
    const double early = hostSeconds();
    timeline.restart();
    EXPECT_EQ(timeline.completeSince(), 0);
    timeline.add("gpu", {"a late one", early, hostSeconds()});
    EXPECT_TRUE(timeline.lanes().empty());
    timeline.add("gpu", {"its own", hostSeconds(), hostSeconds()});
    ASSERT_EQ(timeline.lanes().size(), 1U);
    EXPECT_EQ(timeline.lanes()[0].spans[0].name, "its own");
}

TEST(Timeline, TakesSpansFromManyThreads) {
    Timeline timeline;
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&timeline, t] {
            for (int k = 0; k < 1000; ++k) timeline.add(std::to_string(t), {"", double(k), k + 1.0});
        });
    for (std::thread& thread : threads) thread.join();
    ASSERT_EQ(timeline.lanes().size(), 4U);
    for (const Timeline::Lane& lane : timeline.lanes()) EXPECT_EQ(lane.spans.size(), 1000U);
}

}  // namespace
}  // namespace rivulet::timeline_test
