#include "engine/gpu/timer.h"

#include <utility>

#include "engine/core/assert.h"
#include "engine/core/timeline.h"

namespace rivulet::gpu {

QueryName Timer::query() {
    if (!free_.empty()) {
        QueryName taken = std::move(free_.back());
        free_.pop_back();
        return taken;
    }
    GLuint name = 0;
    glCreateQueries(GL_TIMESTAMP, 1, &name);
    return QueryName(name);
}

void Timer::begin(uint64_t tag) {
    // The two clocks drift.
    if (const double now = hostSeconds(); told_ < 0 || now > told_ + 1) {
        GLint64 gpu = 0;
        glGetInteger64v(GL_TIMESTAMP, &gpu);
        told_ = now;
        ahead_ = now - 1.0e-9 * static_cast<double>(gpu);
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
    // Their names may be others' in the new context: they go with the old one.
    for (QueryName& name : free_) name.letGo();
    for (Span& span : pending_) {
        span.begin.letGo();
        span.end.letGo();
    }
    free_.clear();
    pending_.clear();
    told_ = -1;
}

void Timer::collect(const std::function<void(uint64_t tag, const Times& times)>& then) {
    while (!pending_.empty()) {
        Span& front = pending_.front();
        // The GPU writes timestamps in order: with the end there, so is the beginning.
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
        const double begin = ahead_ + 1.0e-9 * static_cast<double>(from);
        then(tag, {begin, begin + (to > from ? 1.0e-9 * static_cast<double>(to - from) : 0.0)});
    }
}

}  // namespace rivulet::gpu
