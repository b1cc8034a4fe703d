#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "engine/core/json.h"
#include "engine/core/param_path.h"
#include "engine/core/param_value.h"

namespace rivulet {

namespace {

// "colliders.2.mesh" or "colliders[2].mesh": {"colliders", "2", "mesh"}.
std::vector<std::string> segmentsOf(std::string_view path) {
    std::vector<std::string> segments(1);
    for (char c : path) {
        if (c == '.' || c == '[')
            segments.emplace_back();
        else if (c != ']')
            segments.back() += c;
    }
    return segments;
}

// Follows the path and sets the value at its end. An error is reported with the path of the level where it was found.
class ParamSetter final : public ParamVisitor {
  public:
    ParamSetter(std::string_view path, std::string_view text) : segments_(segmentsOf(path)), text_(text) {}

    // "" when the value was set.
    std::string complaint(const VisitFn& visit) const {
        if (finished_) return complaint_;
        return unknownParam(group_, segments_[depth_], beside_, visit);
    }

    void value(const ParamInfo& info, float& v) override { take(info, v); }
    void value(const ParamInfo& info, int& v) override { take(info, v); }
    void value(const ParamInfo& info, bool& v) override { take(info, v); }
    void value(const ParamInfo& info, std::string& v) override { take(info, v); }
    void value(const ParamInfo& info, vec3& v) override { take(info, v); }
    void colour(const ParamInfo& info, vec3& v) override { take(info, v); }
    void choice(const ParamInfo& info, std::string& v, std::span<const std::string> names) override {
        if (isNext(info) && isValue(info)) finish(pathOf(group_, info.name), assignChoice(text_, v, names));
    }

  protected:
    bool beginGroup(const ParamInfo& info) override {
        if (!isNext(info)) return false;
        if (depth_ + 1 == segments_.size()) {
            finish(pathOf(group_, info.name), "is a group of parameters; name one of them");
            return false;
        }
        descend(pathOf(group_, info.name), 1);
        return true;
    }
    void endGroup() override { leave(); }

    size_t beginList(const ParamInfo& info, size_t current) override {
        wantedItems_.push_back(kNone);
        if (!isNext(info)) return current;
        const std::string path = pathOf(group_, info.name);
        if (depth_ + 2 >= segments_.size()) {
            finish(path, fmt::format("is a list; name an item and its parameter, as in {}.0.name=value", path));
            return current;
        }
        const std::string& typed = segments_[depth_ + 1];
        size_t index = 0;
        const auto [end, error] = std::from_chars(typed.data(), typed.data() + typed.size(), index);
        if (error != std::errc{} || end != typed.data() + typed.size() || index > current) {
            finish(path, fmt::format("has {} items; the index must be between 0 and {} (which appends one), but is {}", current, current,
                                     excerpt(typed)));
            return current;
        }
        wantedItems_.back() = index;
        return std::max(current, index + 1);
    }
    void beginItem(size_t index) override {
        if (index == wantedItems_.back())
            descend(pathOf(pathOf(group_, segments_[depth_]), index), 2);
        else
            ++skipped_;
    }
    void endItem() override {
        if (skipped_ > 0)
            --skipped_;
        else
            leave();
    }
    void endList() override { wantedItems_.pop_back(); }

  private:
    static constexpr size_t kNone = static_cast<size_t>(-1);

    bool isNext(const ParamInfo& info) {
        if (finished_ || left_ || skipped_ > 0) return false;
        beside_.emplace_back(info.name);
        return segments_[depth_] == info.name;
    }

    bool isValue(const ParamInfo& info) {
        if (depth_ + 1 < segments_.size()) finish(pathOf(group_, info.name), "is a single value; it has no members");
        return !finished_;
    }

    template <class T>
    void take(const ParamInfo& info, T& v) {
        if (isNext(info) && isValue(info)) finish(pathOf(group_, info.name), assignValue(info, text_, v));
    }

    void descend(std::string group, size_t segments) {
        group_ = std::move(group);
        depth_ += segments;
        beside_.clear();
    }

    // The path leads into this group: if the name was not found here, it does not exist.
    void leave() { left_ = true; }

    void finish(const std::string& path, const std::string& complaint) {
        finished_ = true;
        if (!complaint.empty()) complaint_ = path + " " + complaint;
    }

    std::vector<std::string> segments_;
    std::string_view text_;
    size_t depth_ = 0;                 // segments_[depth_] is looked for
    std::string group_;                // in this group
    std::vector<std::string> beside_;  // which has these names
    std::vector<size_t> wantedItems_;  // of the lists being visited, the innermost last
    int skipped_ = 0;                  // items around this one that the path does not lead into
    bool finished_ = false, left_ = false;
    std::string complaint_;
};

}  // namespace

Status setParam(std::string_view assignment, const VisitFn& visit) {
    const size_t equals = assignment.find('=');
    if (equals == std::string_view::npos || equals == 0)
        return badInput(
            fmt::format("{} is not of the form path.to.param=value", assignment.empty() ? "an empty text" : excerpt(assignment)));
    ParamSetter setter(assignment.substr(0, equals), assignment.substr(equals + 1));
    visit(setter);
    const std::string complaint = setter.complaint(visit);
    return complaint.empty() ? ok() : Status(badInput(complaint));
}

}  // namespace rivulet
