#include "fluid/sim/solids/body_forecast.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rivulet {

namespace {

constexpr double kStep = 1.0 / 120;  // s, of a prediction with contacts, at most
constexpr float kWay = 0.5F;         // of a body's reach in such a step, at most
constexpr float kCalm = 0.02F;       // m/s: what is as slow in two reports rests; what turns back in the air is so slow in one at most
constexpr double kMostSteps = 8;     // of each of the two parts of a prediction
constexpr double kMostMoves = 1024;  // of bodies, in the steps of a part

quat turnedFor(const BodyState& s, float seconds) {
    const float rate = glm::length(s.spin);
    return rate * seconds != 0 ? glm::normalize(glm::angleAxis(rate * seconds, s.spin / rate) * s.pose.rotation) : s.pose.rotation;
}

// Between two states of a path, `share` of the `seconds` between them.
BodyState amid(const BodyState& a, const BodyState& b, float share, float seconds) {
    const float t = share, back = 1 - share;
    BodyState s;
    // Hermite: exact on a parabola.
    s.pose.position = (1 + 2 * t) * back * back * a.pose.position + (3 - 2 * t) * t * t * b.pose.position +
                      seconds * (t * back * back * a.velocity - t * t * back * b.velocity);
    s.pose.rotation = between(a.pose, b.pose, double{share}).rotation;
    s.velocity = glm::mix(a.velocity, b.velocity, t);
    s.spin = glm::mix(a.spin, b.spin, t);
    return s;
}

}  // namespace

BodyForecast::BodyForecast(std::span<const Body> bodies)
    : states_(bodies.size()), loads_(bodies.size()), acceleration_(bodies.size(), vec3(0.0F)), trust_(bodies.size(), 1.0F) {
    mass_.reserve(bodies.size());
    reach_.reserve(bodies.size());
    for (const Body& b : bodies) {
        float reach = 0;
        for (const vec3& p : b.shape.samples) reach = std::max(reach, glm::length(p));
        mass_.push_back(b.shape.mass);
        reach_.push_back(reach);
    }
}

void BodyForecast::set(std::span<const BodyState> states, std::span<const BodyLoad> loads, double time) {
    rests_ = std::exchange(known_, true) && time > time_;
    for (size_t k = 0; k < states.size() && rests_; ++k) {
        const auto slow = [&](const BodyState& s) { return glm::length(s.velocity) + reach_[k] * glm::length(s.spin) < kCalm; };
        rests_ = !(mass_[k] > 0) || (slow(states[k]) && slow(states_[k]));
    }
    states_.assign(states.begin(), states.end());
    loads_.assign(loads.begin(), loads.end());
    time_ = time;
}

bool BodyForecast::arrived(std::span<const BodyState> states, std::span<const BodyLoad> loads, double time) {
    if (!(time > time_)) return false;
    set(states, loads, time);
    return true;
}

void BodyForecast::expect(const BodyHost* host, const vec3& gravity, double now, double end) {
    for (size_t k = 0; k < states_.size(); ++k)
        acceleration_[k] = mass_[k] > 0 ? gravity + vec3(loads_[k].force / double{mass_[k]}) : vec3(0.0F);
    path_.assign(1, {time_, states_});
    for (const double until : {now, end}) {
        const double from = path_.back().time, span = until - from;
        if (!(span > 0)) continue;
        if (host == nullptr || host->predict == nullptr) {
            path_.push_back({until, onward(path_.back(), until)});
            continue;
        }
        double steps = std::ceil(span / kStep);
        for (size_t k = 0; k < states_.size(); ++k) {
            const auto seconds = static_cast<float>(span);
            const float way = seconds * (glm::length(path_.back().states[k].velocity) + seconds * glm::length(acceleration_[k]));
            if (mass_[k] > 0 && reach_[k] > 0) steps = std::max(steps, std::ceil(double{way / (kWay * reach_[k])}));
        }
        const double most = std::clamp(kMostMoves / static_cast<double>(states_.size()), 2.0, kMostSteps);
        const int count = static_cast<int>(std::clamp(steps, 2.0, most));
        for (int n = 0; n < count; ++n) {
            Moment next{n + 1 == count ? until : from + span * (n + 1) / count, path_.back().states};
            const double before = path_.back().time;
            host->predict(host->self, loads_, gravity, before - now, next.time - before, next.states);
            for (size_t k = 0; k < next.states.size(); ++k)
                if (!isSound(next.states[k].pose) || !isWithin(next.states[k].velocity, kMostSpeed) ||
                    !isWithin(next.states[k].spin, kMostSpeed))
                    next.states[k] = path_.back().states[k];
            path_.push_back(std::move(next));
        }
    }
}

void BodyForecast::expectRest(double end) {
    path_.assign(1, {time_, states_});
    if (end > time_) path_.push_back({end, states_});
}

std::vector<BodyState> BodyForecast::onward(const Moment& from, double time) const {
    std::vector<BodyState> then = from.states;
    const auto t = static_cast<float>(time - from.time);
    for (size_t k = 0; k < then.size(); ++k) {
        if (!(mass_[k] > 0)) continue;
        BodyState& s = then[k];
        s.pose.position += t * (s.velocity + 0.5F * t * acceleration_[k]);
        s.velocity += t * acceleration_[k];
        s.pose.rotation = turnedFor(s, t);
    }
    return then;
}

std::vector<BodyState> BodyForecast::at(double time) const {
    if (path_.empty()) return states_;
    const auto after = std::ranges::find_if(path_, [&](const Moment& m) { return m.time >= time; });
    if (after == path_.begin() || after == path_.end()) return onward(after == path_.end() ? path_.back() : path_.front(), time);
    const Moment &a = *(after - 1), &b = *after;
    if (b.time == time) return b.states;
    std::vector<BodyState> then;
    then.reserve(states_.size());
    const auto seconds = static_cast<float>(b.time - a.time), share = static_cast<float>((time - a.time) / (b.time - a.time));
    for (size_t k = 0; k < states_.size(); ++k) then.push_back(mass_[k] > 0 ? amid(a.states[k], b.states[k], share, seconds) : a.states[k]);
    return then;
}

float BodyForecast::gain(size_t body, double time) const {
    const float most = glm::length(states_[body].velocity) + kBlow;
    return std::min(kReserve * std::max(glm::length(acceleration_[body]), kLeast) * static_cast<float>(time - time_), most);
}

void BodyForecast::frame(size_t body, bool strayed) {
    constexpr float kMost = 64, kForgets = 0.98F;
    float& t = trust_[body];
    t = strayed ? std::min(2 * t, kMost) : std::max(kForgets * t, 1.0F);
}

float BodyForecast::reserve(size_t body, float gravity) const {
    return kReserve * trust_[body] * std::max({glm::length(acceleration_[body]), gravity, kLeast});
}

std::vector<vec4> BodyForecast::balls(double from, double to, float gravity) const {
    std::vector<std::vector<BodyState>> moments = {at(from)};
    double longest = 0, last = from;  // s, between two of them
    for (const Moment& m : path_)
        if (m.time > from && m.time < to) {
            moments.push_back(m.states);
            longest = std::max(longest, m.time - last);
            last = m.time;
        }
    moments.push_back(at(to));
    longest = std::max(longest, to - last);
    std::vector<vec4> balls;
    balls.reserve(states_.size());
    const auto since = static_cast<float>(to - time_), length = static_cast<float>(longest);
    for (size_t k = 0; k < states_.size(); ++k) {
        if (!(mass_[k] > 0)) {
            balls.emplace_back(states_[k].pose.position, 0.0F);
            continue;
        }
        Bounds path;
        for (const std::vector<BodyState>& m : moments) path.add(m[k].pose.position);
        const vec3 middle = 0.5F * (path.min + path.max);
        float radius = 0;
        for (const std::vector<BodyState>& m : moments) radius = std::max(radius, glm::length(m[k].pose.position - middle));
        // The path between two is a parabola, which is off its chord by an eighth of its acceleration at most.
        const float bent = 0.125F * glm::length(acceleration_[k]) * length * length;
        balls.emplace_back(middle, radius + bent + 0.5F * reserve(k, gravity) * since * since);
    }
    return balls;
}

}  // namespace rivulet
