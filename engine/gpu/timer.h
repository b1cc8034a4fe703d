// Timer: GPU time of the commands between begin() and end(). Results arrive 2 to 3 frames late; no call waits.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <vector>

#include "engine/gpu/gl_object.h"

namespace rivulet::gpu {

class Timer {
  public:
    // Spans may nest and may overlap those of other Timers (they use timestamps, not GL_TIME_ELAPSED). collect() returns `tag`.
    // While kMaxPending spans have not been collected, new ones are not measured.
    void begin(uint64_t tag);
    void end();
    void next(uint64_t tag);  // end(), and begin() at the same moment

    struct Times {
        double begin = 0, end = 0;  // s, of hostSeconds()
        double ms() const { return 1000 * (end - begin); }
    };
    // Calls then(tag, times) for the finished spans in the order of their end(), up to the first whose result has not arrived.
    void collect(const std::function<void(uint64_t tag, const Times& times)>& then);
    size_t pending() const { return pending_.size(); }
    // Call this when another context becomes current, because contexts do not share queries. Pending spans are dropped; none may be open.
    void contextChanged();
    static constexpr size_t kMaxPending = 4096;

  private:
    struct Mark {
        QueryName query;
        uint64_t ns = 0;
        bool read = false;
    };
    struct Span {
        uint64_t tag = 0;
        std::shared_ptr<Mark> begin, end;  // null: untimed
    };
    std::shared_ptr<Mark> mark();
    void open(uint64_t tag, std::shared_ptr<Mark> at);
    void close(std::shared_ptr<Mark> at);
    uint64_t timeOf(std::shared_ptr<Mark>& mark);

    std::vector<Span> open_;
    std::deque<Span> pending_;
    std::vector<QueryName> free_;
    double clockOffset_ = 0, lastClockSync_ = -1;  // s: host clock minus GPU clock; host time of the last comparison
};

}  // namespace rivulet::gpu
