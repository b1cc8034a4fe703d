#include "engine/gpu/timer.h"

#include <rivulet_glad/gl.h>

#include <utility>

#include "engine/core/assert.h"
#include "engine/core/timeline.h"

namespace rivulet::gpu {

std::shared_ptr<Timer::Mark> Timer::mark() {
    auto at = std::make_shared<Mark>();
    if (free_.empty()) {
        GLuint name = 0;
        glCreateQueries(GL_TIMESTAMP, 1, &name);
        at->query = QueryName(name);
    } else {
        at->query = std::move(free_.back());
        free_.pop_back();
    }
    glQueryCounter(at->query.name(), GL_TIMESTAMP);
    return at;
}

void Timer::open(uint64_t tag, std::shared_ptr<Mark> at) { open_.push_back({tag, std::move(at), nullptr}); }

void Timer::close(std::shared_ptr<Mark> at) {
    Span span = std::move(open_.back());
    open_.pop_back();
    if (!span.begin) return;
    span.end = std::move(at);
    pending_.push_back(std::move(span));
}

void Timer::begin(uint64_t tag) {
    // The two clocks drift, so they are compared once a second.
    if (const double now = hostSeconds(); lastClockSync_ < 0 || now > lastClockSync_ + 1) {
        GLint64 gpu = 0;
        glGetInteger64v(GL_TIMESTAMP, &gpu);
        lastClockSync_ = now;
        clockOffset_ = now - 1.0e-9 * static_cast<double>(gpu);
    }
    open(tag, pending_.size() + open_.size() < kMaxPending ? mark() : nullptr);
}

void Timer::end() {
    ASSERT(!open_.empty(), "call begin() before end()");
    close(open_.back().begin ? mark() : nullptr);
}

void Timer::next(uint64_t tag) {
    ASSERT(!open_.empty(), "call begin() before next()");
    const bool timed = open_.back().begin != nullptr;
    const std::shared_ptr<Mark> at = timed && pending_.size() + open_.size() < kMaxPending ? mark() : nullptr;
    close(timed && !at ? mark() : at);
    open(tag, at);
}

void Timer::contextChanged() {
    ASSERT(open_.empty(), "call end() first");
    // The new context may use the same names for other objects; the old context deletes its queries itself.
    for (QueryName& name : free_) name.release();
    for (Span& span : pending_) {
        span.begin->query.release();
        span.end->query.release();
    }
    free_.clear();
    pending_.clear();
    lastClockSync_ = -1;
}

// The time (ns) of a mark; the last span that has it gives its query back.
uint64_t Timer::timeOf(std::shared_ptr<Mark>& mark) {
    if (!mark->read) {
        GLuint64 ns = 0;
        glGetQueryObjectui64v(mark->query.name(), GL_QUERY_RESULT, &ns);
        mark->ns = ns;
        mark->read = true;
    }
    const uint64_t ns = mark->ns;
    if (mark.use_count() == 1) free_.push_back(std::move(mark->query));
    mark.reset();
    return ns;
}

void Timer::collect(const std::function<void(uint64_t tag, const Times& times)>& then) {
    const auto arrived = [](const Span& span) {
        if (span.end->read) return true;
        GLuint there = GL_FALSE;
        glGetQueryObjectuiv(span.end->query.name(), GL_QUERY_RESULT_AVAILABLE, &there);
        return there == GL_TRUE;
    };
    // The GPU writes timestamps in order: if the last is available, so are all.
    const bool all = !pending_.empty() && arrived(pending_.back());
    while (!pending_.empty()) {
        Span span = std::move(pending_.front());
        if (!all && !arrived(span)) {
            pending_.front() = std::move(span);
            return;
        }
        pending_.pop_front();
        const uint64_t from = timeOf(span.begin), to = timeOf(span.end);
        const double begin = clockOffset_ + 1.0e-9 * static_cast<double>(from);
        then(span.tag, {begin, begin + (to > from ? 1.0e-9 * static_cast<double>(to - from) : 0.0)});
    }
}

}  // namespace rivulet::gpu
