#include "engine/core/timeline.h"

#include <json/json.h>

#include <algorithm>
#include <chrono>
#include <iterator>

#include "engine/core/json_text.h"

namespace rivulet {

namespace {

// The spans sorted by begin; overlapping ones are merged.
std::vector<PassSpan> merged(std::vector<PassSpan> spans) {
    std::sort(spans.begin(), spans.end(), [](const PassSpan& a, const PassSpan& b) { return a.begin < b.begin; });
    std::vector<PassSpan> whole;
    for (PassSpan& s : spans) {
        if (!whole.empty() && s.begin <= whole.back().end)
            whole.back().end = std::max(whole.back().end, s.end);
        else
            whole.push_back(std::move(s));
    }
    return whole;
}

}  // namespace

double hostSeconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

void Timeline::add(std::string_view lane, PassSpan span) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (span.begin < begun_) return;
    if (count_ >= most_) {
        count_ = 0;
        for (Lane& l : lanes_) {
            const auto kept = l.spans.begin() + static_cast<std::ptrdiff_t>((l.spans.size() + 1) / 2);
            for (auto s = l.spans.begin(); s != kept; ++s) since_ = std::max(since_, s->end);
            l.spans.erase(l.spans.begin(), kept);
            count_ += l.spans.size();
        }
    }
    auto found = std::find_if(lanes_.begin(), lanes_.end(), [&](const Lane& l) { return l.name == lane; });
    if (found == lanes_.end()) found = lanes_.insert(lanes_.end(), Lane{std::string(lane), {}});
    found->spans.push_back(std::move(span));
    ++count_;
}

SpanSink Timeline::lane(std::string name) {
    return [this, name = std::move(name)](const PassSpan& span) { add(name, span); };
}

std::vector<Timeline::Lane> Timeline::lanes(double from) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::vector<Lane> some;
    for (const Lane& l : lanes_) {
        some.push_back({l.name, {}});
        // Callers want the newest spans of minutes. These are at the end, nearly in order, because spans are added when they end.
        constexpr double kLate = 1;  // s
        auto first = l.spans.end();
        while (first != l.spans.begin() && std::prev(first)->end > from - kLate) --first;
        std::copy_if(first, l.spans.end(), std::back_inserter(some.back().spans), [&](const PassSpan& s) { return s.end > from; });
    }
    return some;
}

double Timeline::completeSince() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return since_;
}

void Timeline::restart() {
    const std::lock_guard<std::mutex> lock(mutex_);
    lanes_.clear();
    count_ = 0;
    since_ = 0;
    begun_ = hostSeconds();
}

std::string Timeline::chromeTrace() const {
    const std::vector<Lane> all = lanes();
    double first = 0;
    bool any = false;
    for (const Lane& l : all)
        for (const PassSpan& s : l.spans) {
            first = any ? std::min(first, s.begin) : s.begin;
            any = true;
        }
    Json::Value events(Json::arrayValue);
    for (size_t k = 0; k < all.size(); ++k) {
        Json::Value name(Json::objectValue);
        name["name"] = "thread_name";
        name["ph"] = "M";
        name["pid"] = 1;
        name["tid"] = static_cast<Json::UInt>(k + 1);
        name["args"]["name"] = all[k].name;
        events.append(std::move(name));
        for (const PassSpan& s : all[k].spans) {
            Json::Value event(Json::objectValue);
            event["name"] = s.name;
            event["ph"] = "X";
            event["pid"] = 1;
            event["tid"] = static_cast<Json::UInt>(k + 1);
            event["ts"] = 1.0e6 * (s.begin - first);
            event["dur"] = 1.0e6 * std::max(s.end - s.begin, 0.0);
            events.append(std::move(event));
        }
    }
    Json::Value trace(Json::objectValue);
    trace["displayTimeUnit"] = "ms";
    trace["traceEvents"] = std::move(events);
    return jsonText(trace, 15, "");
}

double overlapSeconds(const std::vector<PassSpan>& a, const std::vector<PassSpan>& b) {
    const std::vector<PassSpan> one = merged(a), other = merged(b);
    double both = 0;
    for (size_t i = 0, k = 0; i < one.size() && k < other.size();) {
        both += std::max(std::min(one[i].end, other[k].end) - std::max(one[i].begin, other[k].begin), 0.0);
        one[i].end < other[k].end ? ++i : ++k;
    }
    return both;
}

}  // namespace rivulet
