// Timeline: who worked on what and when, each worker in a lane of its own: what overlaps is seen. Written as Chrome's trace format, which
// chrome://tracing and Perfetto open.
#pragma once

#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace rivulet {

double hostSeconds();  // of the host's steady clock: what all spans are on

// One piece of work.
struct PassSpan {
    std::string name;
    double begin = 0, end = 0;  // s, of hostSeconds()
};
using SpanSink = std::function<void(const PassSpan&)>;

class Timeline {
  public:
    // Of what would be more, the oldest half is forgotten.
    explicit Timeline(size_t most = size_t{1} << 20) : most_(most) {}

    // From any thread. A lane is there from its first span on.
    void add(std::string_view lane, PassSpan span);
    SpanSink lane(std::string name);  // of spans into that lane; must not outlive the timeline

    struct Lane {
        std::string name;
        std::vector<PassSpan> spans;  // as they came
    };
    // What ended after `from`, s. A lane's spans are told of in the order of their ends, to a second.
    std::vector<Lane> lanes(double from = 0) const;
    // s of hostSeconds(): all that ended later is there still. 0: nothing has been forgotten.
    double remembersSince() const;
    void restart();  // as new; of what began before now it hears no more, as it does some frames late of a GPU

    // One JSON object of complete events ("X", microseconds since the first span's begin), a thread a lane. Ends in a newline.
    std::string chromeTrace() const;

  private:
    mutable std::mutex mutex_;
    std::vector<Lane> lanes_;
    size_t most_, count_ = 0;
    double since_ = 0;  // s, as remembersSince()
    double begun_ = 0;  // s, when it was last started
};

// Seconds in which both work. Spans of a lane may overlap and come in any order.
double overlapSeconds(const std::vector<PassSpan>& a, const std::vector<PassSpan>& b);

// Adds what lasts as long as it.
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
