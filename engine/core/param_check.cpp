#include "engine/core/param_check.h"

#include <fmt/format.h>

#include <optional>
#include <string>
#include <vector>

#include "engine/core/param_path.h"
#include "engine/core/param_value.h"

namespace rivulet {

namespace {

// Writes each value as text and reads it back with the functions that read files, so that the rules are written once.
class Checker final : public ParamVisitor {
  public:
    explicit Checker(std::string_view group) : paths_{std::string(group)} {}
    Status found() const { return wrong_ ? Status(badInput(*wrong_)) : ok(); }

    void value(const ParamInfo& info, float& v) override {
        float read = 0;
        note(info, assignValue(info, fmt::format("{}", v), read));
    }
    void value(const ParamInfo& info, int& v) override {
        int read = 0;
        note(info, assignValue(info, fmt::format("{}", v), read));
    }
    void value(const ParamInfo&, bool&) override {}
    void value(const ParamInfo&, std::string&) override {}
    void value(const ParamInfo& info, vec3& v) override {
        vec3 read{0.0F};
        note(info, assignValue(info, fmt::format("[{}, {}, {}]", v.x, v.y, v.z), read));
    }
    void colour(const ParamInfo& info, vec3& v) override { value(info, v); }
    void choice(const ParamInfo& info, std::string& v, std::span<const std::string> names) override {
        std::string read;
        note(info, assignChoice(v, read, names));
    }

  protected:
    bool beginGroup(const ParamInfo& info) override {
        paths_.push_back(pathOf(paths_.back(), info.name));
        return true;
    }
    void endGroup() override { paths_.pop_back(); }
    size_t beginList(const ParamInfo& info, size_t current) override {
        paths_.push_back(pathOf(paths_.back(), info.name));
        return current;
    }
    void beginItem(size_t index) override { paths_.push_back(pathOf(paths_.back(), index)); }
    void endItem() override { paths_.pop_back(); }
    void endList() override { paths_.pop_back(); }

  private:
    void note(const ParamInfo& info, const std::string& complaint) {
        if (!wrong_ && !complaint.empty()) wrong_ = pathOf(paths_.back(), info.name) + " " + complaint;
    }

    std::vector<std::string> paths_;
    std::optional<std::string> wrong_;
};

}  // namespace

Status checkParams(std::string_view group, const VisitFn& visit) {
    Checker checker(group);
    visit(checker);
    return checker.found();
}

}  // namespace rivulet
