#include "engine/gpu/timer.h"

#include <rivulet_glad/gl.h>

#include <utility>

#include "engine/core/assert.h"
#include "engine/core/timeline.h"

namespace rivulet::gpu {

QueryName Timer::query() {
    if (!free_.empty()) {
        QueryName name = std::move(free_.back());
        free_.pop_back();
        return name;
    }
    GLuint name = 0;
    glCreateQueries(GL_TIMESTAMP, 1, &name);
    return QueryName(name);
}

void Timer::begin(uint64_t tag) {
    // The two clocks drift, so they are compared once a second.
    if (const double now = hostSeconds(); lastClockSync_ < 0 || now > lastClockSync_ + 1) {
        GLint64 gpu = 0;
        glGetInteger64v(GL_TIMESTAMP, &gpu);
        lastClockSync_ = now;
        clockOffset_ = now - 1.0e-9 * static_cast<double>(gpu);
    }
    Span span{tag, {}, {}};
    if (pending_.size() + open_.size() < kMaxPending) {
        span.begin = query();
        glQueryCounter(span.begin.name(), GL_TIMESTAMP);
    }
    open_.push_back(std::move(span));
}

void Timer::end() {
    ASSERT(!open_.empty(), "call begin() before end()");
    Span span = std::move(open_.back());
    open_.pop_back();
    if (!span.begin) return;
    span.end = query();
    glQueryCounter(span.end.name(), GL_TIMESTAMP);
    pending_.push_back(std::move(span));
}

void Timer::contextChanged() {
    ASSERT(open_.empty(), "call end() first");
    // The new context may use the same names for other objects; the old context deletes its queries itself.
    for (QueryName& name : free_) name.release();
    for (Span& span : pending_) {
        span.begin.release();
        span.end.release();
    }
    free_.clear();
    pending_.clear();
    lastClockSync_ = -1;
}

void Timer::collect(const std::function<void(uint64_t tag, const Times& times)>& then) {
    while (!pending_.empty()) {
        Span& front = pending_.front();
        // The GPU writes timestamps in order: if the end is available, so is the beginning.
        GLuint arrived = GL_FALSE;
        glGetQueryObjectuiv(front.end.name(), GL_QUERY_RESULT_AVAILABLE, &arrived);
        if (arrived == GL_FALSE) return;
        GLuint64 from = 0, to = 0;
        glGetQueryObjectui64v(front.begin.name(), GL_QUERY_RESULT, &from);
        glGetQueryObjectui64v(front.end.name(), GL_QUERY_RESULT, &to);
        const uint64_t tag = front.tag;
        free_.push_back(std::move(front.begin));
        free_.push_back(std::move(front.end));
        pending_.pop_front();
        const double begin = clockOffset_ + 1.0e-9 * static_cast<double>(from);
        then(tag, {begin, begin + (to > from ? 1.0e-9 * static_cast<double>(to - from) : 0.0)});
    }
}

}  // namespace rivulet::gpu
