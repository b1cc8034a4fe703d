#include "tests/fuzz/sliders.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "engine/core/param_path.h"
#include "engine/core/param_value.h"
#include "fluid/sim/sources/liquids.h"

namespace rivulet::fuzz {

namespace {

// Visits a scene and tracks the current path.
class PathVisitor : public ParamVisitor {
  protected:
    bool beginGroup(const ParamInfo& info) override {
        groups_.push_back(pathOf(group(), info.name));
        return true;
    }
    void endGroup() override { groups_.pop_back(); }
    size_t beginList(const ParamInfo& info, size_t current) override {
        lists_.push_back(pathOf(group(), info.name));
        return current;
    }
    void beginItem(size_t index) override { groups_.push_back(pathOf(lists_.back(), index)); }
    void endItem() override { groups_.pop_back(); }
    void endList() override { lists_.pop_back(); }
    std::string group() const { return groups_.empty() ? "" : groups_.back(); }

  private:
    std::vector<std::string> groups_, lists_;
};

class Collector final : public PathVisitor {
  public:
    std::vector<Slider> sliders;

    void value(const ParamInfo& info, float& v) override {
        Slider& s = add(info, Slider::Kind::real, valueText(v));
        s.base = double{v};
    }
    void value(const ParamInfo& info, int& v) override {
        Slider& s = add(info, Slider::Kind::whole, valueText(v));
        s.base = v;
    }
    void value(const ParamInfo& info, vec3& v) override {
        Slider& s = add(info, Slider::Kind::vector, valueText(v));
        for (int k = 0; k < 3; ++k)
            if (std::abs(double{v[k]}) > std::abs(s.base)) s.base = double{v[k]};
    }
    void colour(const ParamInfo& info, vec3& v) override { value(info, v); }
    void value(const ParamInfo& info, bool& v) override { add(info, Slider::Kind::words, valueText(v)).words = {"false", "true"}; }
    void choice(const ParamInfo& info, std::string& v, std::span<const std::string> names) override {
        add(info, Slider::Kind::words, v).words.assign(names.begin(), names.end());
    }
    // A text may be anything: nothing, what is no name of anything, and every name that a table of texts has.
    void value(const ParamInfo& info, std::string& v) override {
        Slider& s = add(info, Slider::Kind::words, v);
        s.words = liquids().names();
        s.words.insert(s.words.begin(), "");
        s.words.emplace_back("none-such");
    }

  private:
    Slider& add(const ParamInfo& info, Slider::Kind kind, std::string text) {
        Slider s;
        s.path = pathOf(group(), info.name);
        s.kind = kind;
        s.min = std::max(info.min, -1.0e30);
        s.max = std::min(info.max, 1.0e30);
        s.logarithmic = info.logarithmic;
        s.fixed = info.fixed;
        s.length = std::string_view(info.unit) == "m";
        s.text = std::move(text);
        return sliders.emplace_back(std::move(s));
    }
};

class Scaler final : public PathVisitor {
  public:
    explicit Scaler(float factor) : factor_(factor) {}
    void value(const ParamInfo& info, float& v) override {
        if (isLength(info)) v = kept(info, v * factor_);
    }
    void value(const ParamInfo& info, vec3& v) override {
        if (isLength(info))
            for (int k = 0; k < 3; ++k) v[k] = kept(info, v[k] * factor_);
    }
    void value(const ParamInfo&, int&) override {}
    void value(const ParamInfo&, bool&) override {}
    void value(const ParamInfo&, std::string&) override {}
    void colour(const ParamInfo&, vec3&) override {}
    void choice(const ParamInfo&, std::string&, std::span<const std::string>) override {}

  private:
    static bool isLength(const ParamInfo& info) { return std::string_view(info.unit) == "m"; }
    static float kept(const ParamInfo& info, float v) { return std::clamp(v, static_cast<float>(info.min), static_cast<float>(info.max)); }
    float factor_;
};

// Where a logarithmic range has 0 at its end, its slider comes down to this share of the other end before.
constexpr double kLeast = 1.0e-8;

}  // namespace

double uniform(Random& random) { return static_cast<double>(random() >> 11U) * 0x1p-53; }
size_t below(Random& random, size_t count) {
    return std::min(static_cast<size_t>(uniform(random) * static_cast<double>(count)), count - 1);
}
bool oneIn(Random& random, size_t times) { return below(random, times) == 0; }

uint64_t hashOf(std::string_view text) {
    uint64_t hash = 0xcbf29ce484222325ULL;
    for (const char c : text) hash = (hash ^ static_cast<uint8_t>(c)) * 0x100000001b3ULL;
    return hash;
}

std::string Slider::number(double v) const {
    if (kind == Kind::whole)
        return valueText(static_cast<int>(std::clamp(std::round(v), std::max(min, -2147483648.0), std::min(max, 2147483647.0))));
    // A float beside an end may lie beyond it by rounding.
    auto f = static_cast<float>(std::clamp(v, min, max));
    return valueText(f);
}

std::vector<std::string> Slider::ends() const {
    if (kind == Kind::words) return {words.front(), words.back()};
    if (kind != Kind::vector) return {number(min), number(max)};
    const std::string low = number(min), high = number(max);
    return {low + "," + low + "," + low, high + "," + high + "," + high};
}

std::vector<std::string> Slider::values() const {
    if (kind == Kind::words) return words;
    std::vector<std::string> all = ends();
    if (kind == Kind::vector) {
        for (int axis = 0; axis < 3; ++axis)
            for (const double end : {min, max}) {
                std::string one;
                for (int k = 0; k < 3; ++k) one += (k > 0 ? "," : "") + number(k == axis ? end : std::clamp(0.0, min, max));
                all.push_back(one);
            }
        return all;
    }
    const double low = min > 0 ? min : max * kLeast;
    all.push_back(number(logarithmic && max > 0 ? std::sqrt(low * max) : 0.5 * (min + max)));
    return all;
}

double Slider::drawNumber(Random& random, double size) const {
    const size_t pick = below(random, 8);
    if (pick == 0) return min;
    if (pick == 1) return max;
    const double share = uniform(random);
    if (logarithmic && max > 0) {
        const double low = min > 0 ? min : max * kLeast;
        return low * std::pow(max / low, share);
    }
    // A range far wider than what it is about would be a scene torn to pieces each time: near it as often as anywhere.
    const double scale = length ? size : std::max(std::abs(base), 1.0);
    if (max - min > 100 * scale) {
        if (pick < 6) return std::clamp((length ? 0.0 : base) + (2.5 * share - 0.75) * scale, min, max);
        const double most = std::max(std::abs(min), std::abs(max));
        const double far = 0.01 * scale * std::pow(most / (0.01 * scale), share);
        return std::clamp(oneIn(random, 2) ? far : -far, min, max);
    }
    return min + (max - min) * share;
}

std::string Slider::draw(Random& random, double size) const {
    if (kind == Kind::words) return words[below(random, words.size())];
    if (kind != Kind::vector) return number(drawNumber(random, size));
    std::string drawn;
    for (int k = 0; k < 3; ++k) drawn += (k > 0 ? "," : "") + number(drawNumber(random, size));
    return drawn;
}

std::vector<Slider> slidersOf(SceneFile& scene) {
    Collector collector;
    scene.visit(collector);
    // The one switch that takes away what is checked here: without limits methods fail, and tests/stability says where.
    // And what picks by the clock: a case would not repeat.
    std::erase_if(collector.sliders, [](const Slider& s) { return s.path == "fluid.limits" || s.path.starts_with("budget."); });
    return std::move(collector.sliders);
}

void scaleLengths(SceneFile& scene, float factor) {
    const float spacing = scene.fluid.spacing;
    Scaler scaler(factor);
    scene.visit(scaler);
    scene.fluid.spacing = spacing;
}

}  // namespace rivulet::fuzz
