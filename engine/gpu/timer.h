// Timer: how long the GPU worked on what was issued between begin() and end(). Results come some frames late; nothing ever waits.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <vector>

#include "engine/gpu/gl_object.h"

namespace rivulet::gpu {

class Timer {
  public:
    // Spans may nest and may overlap those of other Timers (timestamps, not GL_TIME_ELAPSED). `tag` is handed back by collect().
    // Beyond kMaxPending spans that nobody collected, new ones go untimed.
    void begin(uint64_t tag);
    void end();

    struct Times {
        double begin = 0, end = 0;  // s, of hostSeconds()
        double ms() const { return 1000 * (end - begin); }
    };
    // Calls then(tag, times) for every finished span, in the order of their end(), until one whose result has not arrived.
    void collect(const std::function<void(uint64_t tag, const Times& times)>& then);
    size_t pending() const { return pending_.size(); }
    // Another context is current from now on: queries are not shared. What is pending is never heard of; none may be open.
    void contextChanged();
    static constexpr size_t kMaxPending = 4096;

  private:
    struct Span {
        uint64_t tag = 0;
        QueryName begin, end;  // none: untimed
    };
    QueryName query();

    std::vector<Span> open_;
    std::deque<Span> pending_;
    std::vector<QueryName> free_;
    double ahead_ = 0, told_ = -1;  // s: the host's clock before the GPU's, and when it was asked
};

}  // namespace rivulet::gpu
