#include <fmt/format.h>

#include <map>

#include "engine/core/json.h"
#include "engine/core/param_list.h"
#include "engine/core/param_path.h"
#include "engine/core/param_value.h"

namespace rivulet {

namespace {

// Values by path, as listParams names them.
using Defaults = std::map<std::string, std::string, std::less<>>;

class JsonWriter final : public ParamVisitor {
  public:
    JsonWriter(const Defaults& defaults, bool sparse) : defaults_(defaults), sparse_(sparse) { levels_.emplace_back(); }

    std::string finish() {
        const Level root = pop();
        return block('{', root.members, '}') + "\n";
    }

    void value(const ParamInfo& info, float& v) override { put(info, valueText(v)); }
    void value(const ParamInfo& info, int& v) override { put(info, valueText(v)); }
    void value(const ParamInfo& info, bool& v) override { put(info, valueText(v)); }
    void value(const ParamInfo& info, std::string& v) override { put(info, valueText(v)); }
    void value(const ParamInfo& info, vec3& v) override { put(info, valueText(v)); }
    void colour(const ParamInfo& info, vec3& v) override { put(info, valueText(v)); }
    void choice(const ParamInfo& info, std::string& v, std::span<const std::string>) override { put(info, valueText(v)); }

  protected:
    bool beginGroup(const ParamInfo& info) override {
        levels_.push_back({info.name, pathOf(levels_.back().path, info.name), {}});
        return true;
    }
    void endGroup() override {
        const Level group = pop();
        if (!(sparse_ && group.members.empty())) add(group.name, block('{', group.members, '}'));
    }
    size_t beginList(const ParamInfo& info, size_t current) override {
        levels_.push_back({info.name, pathOf(levels_.back().path, info.name), {}});
        return current;
    }
    void beginItem(size_t) override { levels_.push_back({"", levels_.back().path + "[]", {}}); }
    void endItem() override {
        const Level item = pop();
        levels_.back().members.push_back(block('{', item.members, '}'));
    }
    void endList() override {
        const Level list = pop();
        if (!(list.members.empty() && isDefault(list.path, "[]"))) add(list.name, block('[', list.members, ']'));
    }

  private:
    struct Level {
        std::string name, path;
        std::vector<std::string> members;  // written out, indented for their depth
    };

    bool isDefault(const std::string& path, std::string_view text) const {
        const auto found = defaults_.find(path);
        return sparse_ && found != defaults_.end() && found->second == text;
    }

    void put(const ParamInfo& info, const std::string& text) {
        if (!isDefault(pathOf(levels_.back().path, info.name), text)) add(info.name, text);
    }

    void add(std::string_view name, const std::string& text) { levels_.back().members.push_back(fmt::format("\"{}\": {}", name, text)); }

    Level pop() {
        Level level = std::move(levels_.back());
        levels_.pop_back();
        return level;
    }

    // The stack holds the levels around the block, not the block's own.
    std::string block(char open, const std::vector<std::string>& members, char close) const {
        if (members.empty()) return {open, close};
        const std::string outer = "\n" + std::string(4 * levels_.size(), ' ');
        const std::string inner = outer + "    ";
        return open + inner + fmt::format("{}", fmt::join(members, "," + inner)) + outer + close;
    }

    const Defaults& defaults_;
    bool sparse_;
    std::vector<Level> levels_;
};

}  // namespace

std::string writeJson(const VisitFn& visit, const VisitFn* defaults) {
    Defaults texts;
    if (defaults != nullptr)
        for (ParamEntry& entry : listParams(*defaults)) texts.emplace(std::move(entry.path), std::move(entry.text));
    JsonWriter writer(texts, defaults != nullptr);
    visit(writer);
    return writer.finish();
}

}  // namespace rivulet
