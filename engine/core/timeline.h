// Timeline: begin and end of each piece of work, in one lane per worker (thread, GPU queue), so that overlaps are visible. It is written in
// Chrome's trace format, which chrome://tracing and Perfetto open.
#pragma once

#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/abi.h"

namespace rivulet {

double hostSeconds();  // s, the host's steady clock; all spans use it

// One piece of work.
struct PassSpan {
    std::string name;
    double begin = 0, end = 0;  // s, of hostSeconds()
};
using SpanSink = std::function<void(const PassSpan&)>;

class Timeline {
  public:
    // `most`: spans that are kept. When it is exceeded, the oldest half of each lane is dropped.
    explicit Timeline(size_t most = size_t{1} << 20) : most_(most) {}

    // May be called from any thread. The first span of a lane creates it.
    void add(std::string_view lane, PassSpan span);
    SpanSink lane(std::string name);  // a function that adds spans to the lane; must not outlive the timeline

    struct Lane {
        std::string name;
        std::vector<PassSpan> spans;  // in the order of add()
    };
    // The spans that ended after `from`, s. Requires that the spans of a lane were added in the order of their ends, to within 1 s.
    std::vector<Lane> lanes(double from = 0) const;
    // s, hostSeconds(): all spans that ended later are still stored. 0: no span was dropped.
    double completeSince() const;
    void restart();  // removes all spans; spans that began before this call are ignored (GPU times arrive some frames late)

    // One JSON object of complete events ("X", in microseconds since the first span's begin), one thread per lane. Ends in a newline.
    std::string chromeTrace() const;

  private:
    mutable std::mutex mutex_;
    std::vector<Lane> lanes_;
    size_t most_, count_ = 0;
    double since_ = 0;  // s, as completeSince()
    double begun_ = 0;  // s, hostSeconds() of the last restart()
};

// The time, s, that is covered by spans of both `a` and `b`. Spans may overlap and come in any order.
double overlapSeconds(const std::vector<PassSpan>& a, const std::vector<PassSpan>& b);

// Adds a span from its construction to its destruction; nothing if `to` is null.
class TimedSpan {
  public:
    TimedSpan(Timeline* to, std::string_view lane, std::string_view name)
        : to_(to), lane_(lane), span_{std::string(name), hostSeconds(), 0} {}
    ~TimedSpan() {
        if (to_ == nullptr) return;
        span_.end = hostSeconds();
        to_->add(lane_, std::move(span_));
    }
    TimedSpan(const TimedSpan&) = delete;
    TimedSpan& operator=(const TimedSpan&) = delete;

  private:
    Timeline* to_;
    std::string lane_;
    PassSpan span_;
};

}  // namespace rivulet
