#include "fluid/flow/pendant_drop.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rivulet {

namespace {

constexpr std::array kBends = {0.0, 0.25, 0.5, 0.75, 1.0};
constexpr size_t kShapes = 33;       // by volume, for each bend
constexpr double kSmallest = 0.05;   // of the largest volume
constexpr double kSteepest = 150;    // deg: a larger angle is as that: the drops are too small for the outlines
constexpr double kMostFalls = 0.95;  // a skin keeps a film at least
constexpr double kSmall = 8, kLarge = 0.5,
                 kStep = 1.025;  // curvature at the tip: that of the smallest drop, of the largest, and their steps
constexpr double kWay = 0.02;    // along an outline, from place to place

// A place of a drop's outline, from its tip up.
struct Place {
    double radius = 0, height = 0, slope = 0, volume = 0, way = 0;  // slope: rad, 0 level; volume: below

    Place operator+(const Place& o) const {
        return {radius + o.radius, height + o.height, slope + o.slope, volume + o.volume, way + o.way};
    }
    Place operator*(double t) const { return {radius * t, height * t, slope * t, volume * t, way * t}; }
};

Place mixed(const Place& a, const Place& b, double t) { return a * (1 - t) + b * t; }

Place growth(const Place& p, double curvature) {
    const double around = p.radius < 1.0e-9 ? curvature : std::sin(p.slope) / p.radius;
    return {std::cos(p.slope), std::sin(p.slope), 2 * curvature - p.height - around, kPiD * p.radius * p.radius * std::sin(p.slope), 1};
}

// Up to the second bulge above the tip, where no drop is stable any more.
std::vector<Place> outline(double curvature) {
    constexpr double kLongest = 7;
    std::vector<Place> all(1);
    for (int bulges = 0; all.back().way < kLongest && bulges < 2;) {
        const Place& p = all.back();
        const Place a = growth(p, curvature), b = growth(p + a * (kWay / 2), curvature), c = growth(p + b * (kWay / 2), curvature),
                    d = growth(p + c * kWay, curvature);
        const Place next = p + (a + b * 2 + c * 2 + d) * (kWay / 6);
        if (next.radius < 0) break;
        if (std::cos(p.slope) > 0 && std::cos(next.slope) <= 0) ++bulges;
        all.push_back(next);
    }
    return all;
}

struct Outline {
    double curvature = 0;
    std::vector<Place> places;
};

// A drop in equilibrium: an outline up to its foot, or what lies between two of them.
struct Drop {
    const Outline *from = nullptr, *to = nullptr;
    double between = 0;  // 0 from .. 1 to
    Place foot;
    double volume = 0;  // without what the skin takes of it
};

// Volume of the skin, a ball, below the plane of a foot.
double skinBelow(double foot, double bend) {
    if (bend <= 0) return 0;
    const double radius = 1 / bend, high = radius - std::sqrt(std::max(radius * radius - foot * foot, 0.0));
    return kPiD * high * high * (radius - high / 3);
}

double contact(const Place& p, double bend) { return p.slope - std::asin(std::min(bend * p.radius, 1.0)); }

// As it grows with an advancing foot: without a bulge at first, then with one.
std::vector<Drop> advancing(const std::vector<Outline>& outlines, double angle, double bend) {
    std::vector<Drop> first, second;
    for (const Outline& o : outlines) {
        int met = 0;
        for (size_t k = 1; k < o.places.size() && met < 2; ++k) {
            const double a = contact(o.places[k - 1], bend) - angle, b = contact(o.places[k], bend) - angle;
            if ((a < 0) == (b < 0) || bend * o.places[k].radius > 1) continue;
            const Place foot = mixed(o.places[k - 1], o.places[k], a / (a - b));
            (met++ == 0 ? first : second).push_back({&o, &o, 0, foot, foot.volume - skinBelow(foot.radius, bend)});
        }
    }
    first.insert(first.end(), second.rbegin(), second.rend());
    return first;
}

// As it grows on from there with the same foot: its outline becomes longer.
std::vector<Drop> pinned(const std::vector<Outline>& outlines, const Drop& start, double angle, double bend) {
    constexpr double kNext = 0.1;  // of the tip's curvature: what is further off is another family
    std::vector<Drop> all;
    const double radius = start.foot.radius, below = skinBelow(radius, bend);
    double curvature = start.from->curvature, most = start.volume;
    for (auto k = static_cast<size_t>(start.foot.way / kWay) + 1;; ++k) {
        Drop nearest;
        double off = kNext * curvature;
        for (size_t i = 1; i < outlines.size(); ++i) {
            const Outline &from = outlines[i - 1], &to = outlines[i];
            if (k >= from.places.size() || k >= to.places.size()) continue;
            const double a = from.places[k].radius - radius, b = to.places[k].radius - radius;
            if ((a < 0) == (b < 0)) continue;
            const double between = a / (a - b), away = std::abs(from.curvature + between * (to.curvature - from.curvature) - curvature);
            if (away > off) continue;
            off = away;
            const Place foot = mixed(from.places[k], to.places[k], between);
            nearest = {&from, &to, between, foot, foot.volume - below};
        }
        if (nearest.from == nullptr || nearest.volume < 0.98 * most || contact(nearest.foot, bend) < angle) return all;
        curvature = nearest.from->curvature + nearest.between * (nearest.to->curvature - nearest.from->curvature);
        most = std::max(most, nearest.volume);
        all.push_back(nearest);
    }
}

// Least squares in the radius squared; the volume is the drop's.
DropProfile fitted(const std::vector<Place>& places, double way) {
    const auto last = std::min(static_cast<size_t>(way / kWay), places.size() - 2);
    const Place foot = mixed(places[last], places[last + 1], way / kWay - static_cast<double>(last));
    DropProfile made;
    made.length = foot.height;
    std::array<std::array<double, 5>, 4> m{};
    for (size_t k = 1; k <= last + 1; ++k) {
        const Place& p = k <= last ? places[k] : foot;
        const double s = 1 - p.height / made.length;
        std::array<double, 5> row{};
        for (size_t i = 0; i < 4; ++i) row[i] = (1 - s) * std::pow(s, static_cast<double>(i));
        row[4] = p.radius * p.radius;
        for (size_t i = 0; i < 4; ++i)
            for (size_t j = 0; j < 5; ++j) m[i][j] += row[i] * row[j];
    }
    for (size_t i = 0; i < 4; ++i)
        for (size_t k = 0; k < 4; ++k) {
            if (k == i) continue;
            const double share = m[k][i] / m[i][i];
            for (size_t j = i; j < 5; ++j) m[k][j] -= share * m[i][j];
        }
    for (int i = 0; i < 4; ++i) made.swell[i] = m[static_cast<size_t>(i)][4] / m[static_cast<size_t>(i)][static_cast<size_t>(i)];
    made.swell *= foot.volume / made.volume();
    return made;
}

DropProfile mixed(const DropProfile& a, const DropProfile& b, double t) {
    DropProfile made{a.length + t * (b.length - a.length), a.swell + t * (b.swell - a.swell)};
    made.swell *= glm::mix(a.volume(), b.volume(), t) / made.volume();
    return made;
}

DropProfile fitted(const Drop& d) { return mixed(fitted(d.from->places, d.foot.way), fitted(d.to->places, d.foot.way), d.between); }

}  // namespace

double DropProfile::volume() const { return kPiD * length * (swell.x / 2 + swell.y / 6 + swell.z / 12 + swell.w / 20); }

// The force is r x surface tension / F, F = 0.14782 + 0.27896 x - 0.1662 x^2, for x = r over the cube root of the volume.
double fallenVolume(double foot) {
    double volume = 4 * foot;
    for (int k = 0; k < 50; ++k) {
        const double x = std::clamp(foot / std::cbrt(volume), 0.0, 1.2);
        volume = 0.5 * (volume + foot / (0.14782 + x * (0.27896 - 0.1662 * x)));
    }
    return volume;
}

PendantDrop::PendantDrop(double advancingAngle, double recedingAngle) {
    std::vector<Outline> outlines;
    for (double curvature = kSmall; curvature > kLarge; curvature /= kStep) outlines.push_back({curvature, outline(curvature)});
    const double ahead = std::min(advancingAngle, kSteepest) * kPiD / 180, behind = std::min(recedingAngle * kPiD / 180, ahead);
    for (const double bend : kBends) {
        std::vector<Drop> grown = advancing(outlines, ahead, bend);
        // Its volume grows beyond the widest foot: there the foot stays.
        const auto larger = [](const Drop& a, const Drop& b) { return a.volume < b.volume; };
        const auto widest = std::max_element(grown.begin(), std::max_element(grown.begin(), grown.end(), larger) + 1,
                                             [](const Drop& a, const Drop& b) { return a.foot.radius < b.foot.radius; });
        grown.erase(widest + 1, grown.end());
        const std::vector<Drop> longer = pinned(outlines, grown.back(), behind, bend);
        grown.insert(grown.end(), longer.begin(), longer.end());
        grown.erase(std::max_element(grown.begin(), grown.end(), larger) + 1, grown.end());
        Row row;
        row.largest = grown.back().volume;
        row.falls = std::min(fallenVolume(grown.back().foot.radius) / row.largest, kMostFalls);
        for (size_t k = 0; k < kShapes; ++k) {
            const double volume = row.largest * (kSmallest + (1 - kSmallest) * static_cast<double>(k) / (kShapes - 1));
            const auto at = std::find_if(grown.begin() + 1, grown.end() - 1, [&](const Drop& d) { return d.volume >= volume; });
            const double share = (volume - (at - 1)->volume) / (at->volume - (at - 1)->volume);
            row.shapes.push_back(mixed(fitted(*(at - 1)), fitted(*at), std::clamp(share, 0.0, 1.0)));
        }
        rows_.push_back(std::move(row));
    }
    const double y0 = 1 / rows_[0].largest, y1 = 1 / rows_[2].largest, y2 = 1 / rows_[4].largest;
    inverse_ = {y0, 4 * y1 - 3 * y0 - y2, 2 * (y0 + y2 - 2 * y1)};
    falling_ = {rows_[0].falls, rows_[4].falls - rows_[0].falls};
}

double PendantDrop::largest(double bend) const {
    const double b = std::clamp(bend, 0.0, 1.0);
    return 1 / (inverse_.x + b * (inverse_.y + b * inverse_.z));
}

double PendantDrop::falls(double bend) const { return falling_.x + falling_.y * std::clamp(bend, 0.0, 1.0); }

DropProfile PendantDrop::profile(double bend, double volume) const {
    const double b = std::clamp(bend, 0.0, 1.0) * static_cast<double>(kBends.size() - 1);
    const double v = std::clamp((volume / largest(bend) - kSmallest) / (1 - kSmallest), 0.0, 1.0) * (kShapes - 1);
    const auto row = std::min(static_cast<size_t>(b), kBends.size() - 2), column = std::min(static_cast<size_t>(v), kShapes - 2);
    const double up = b - static_cast<double>(row), along = v - static_cast<double>(column);
    DropProfile sum;
    for (const size_t i : {size_t{0}, size_t{1}})
        for (const size_t j : {size_t{0}, size_t{1}}) {
            const DropProfile& p = rows_[row + i].shapes[column + j];
            const double weight = (i == 0 ? 1 - up : up) * (j == 0 ? 1 - along : along);
            sum.length += weight * p.length;
            sum.swell += weight * p.swell;
        }
    return sum;
}

}  // namespace rivulet
