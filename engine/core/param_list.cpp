#include "engine/core/param_list.h"

#include <fmt/format.h>

#include "engine/core/param_path.h"
#include "engine/core/param_value.h"
#include "engine/core/table.h"

namespace rivulet {

namespace {

class ParamLister final : public ParamVisitor {
  public:
    explicit ParamLister(std::vector<ParamEntry>& entries) : entries_(entries) {}

    void value(const ParamInfo& info, float& v) override { add(info, valueText(v)).range = rangeText(info); }
    void value(const ParamInfo& info, int& v) override { add(info, valueText(v)).range = "whole, " + rangeText(info); }
    void value(const ParamInfo& info, bool& v) override { add(info, valueText(v)).range = "true or false"; }
    void value(const ParamInfo& info, std::string& v) override { add(info, valueText(v)); }
    void value(const ParamInfo& info, vec3& v) override { add(info, valueText(v)).range = rangeText(info); }
    void colour(const ParamInfo& info, vec3& v) override { value(info, v); }
    void choice(const ParamInfo& info, std::string& v, std::span<const std::string> names) override {
        add(info, valueText(v)).range = "one of " + joined(names);
    }

  protected:
    bool beginGroup(const ParamInfo& info) override {
        groups_.push_back(add(info, "", ParamEntry::Kind::group).path);
        return true;
    }
    void endGroup() override { groups_.pop_back(); }
    size_t beginList(const ParamInfo& info, size_t current) override {
        lists_.push_back({add(info, current == 0 ? "[]" : "", ParamEntry::Kind::list).path, current == 0});
        return current;
    }
    void beginItem(size_t index) override {
        const List& list = lists_.back();
        groups_.push_back(list.empty ? list.path + "[]" : pathOf(list.path, index));
    }
    void endItem() override { groups_.pop_back(); }
    void endList() override { lists_.pop_back(); }
    bool documentsItems() const override { return true; }

  private:
    struct List {
        std::string path;
        bool empty;
    };

    ParamEntry& add(const ParamInfo& info, std::string text, ParamEntry::Kind kind = ParamEntry::Kind::value) {
        const std::string group = groups_.empty() ? "" : groups_.back();
        return entries_.emplace_back(ParamEntry{kind, pathOf(group, info.name), info.unit, "", std::move(text), info.doc, info.fixed});
    }

    std::vector<ParamEntry>& entries_;
    std::vector<std::string> groups_;  // paths, the innermost last
    std::vector<List> lists_;
};

std::string tableCell(std::string text) {
    for (size_t i = text.find('|'); i != std::string::npos; i = text.find('|', i + 2)) text.insert(i, "\\");
    return text;
}

}  // namespace

std::vector<ParamEntry> listParams(const VisitFn& visit) {
    std::vector<ParamEntry> entries;
    ParamLister lister(entries);
    visit(lister);
    return entries;
}

std::map<std::string, std::string> paramTexts(const VisitFn& visit) {
    std::map<std::string, std::string> texts;
    for (ParamEntry& entry : listParams(visit))
        if (entry.kind == ParamEntry::Kind::value) texts[entry.path] = std::move(entry.text);
    return texts;
}

std::string plainText(const std::string& json) {
    if (!json.starts_with('"')) return json;
    std::string text;
    for (size_t k = 1; k + 1 < json.size(); ++k) {
        if (json[k] == '\\' && json[k + 1] == 'u') {  // only control characters are written in this form
            text += static_cast<char>(std::stoi(json.substr(k + 2, 4), nullptr, 16));
            k += 5;
            continue;
        }
        const bool line = json[k] == '\\' && json[k + 1] == 'n';
        if (json[k] == '\\') ++k;
        text += line ? '\n' : json[k];
    }
    return text;
}

std::string unknownParam(std::string_view group, std::string_view name, std::span<const std::string> beside, const VisitFn& visit) {
    const std::string complaint = excerpt(pathOf(group, name)) + " is not a parameter; ";
    const std::string near = nearestName(name, beside);
    if (!near.empty()) return complaint + "did you mean " + pathOf(group, near) + "?";
    const std::string ending = "." + std::string(name);
    for (const ParamEntry& entry : listParams(visit))
        if (entry.path.ends_with(ending)) return complaint + "did you mean " + entry.path + "?";
    return complaint + "known here: " + joined(beside);
}

std::string describeParams(const VisitFn& visit) {
    std::string page =
        "# Parameters\n\n"
        "Every parameter of a scene file, as `rivulet list --parameters` prints it. In a file the path is the nesting of JSON objects;\n"
        "on the command line it is `--set path=value`, with a list's item by its index: `--set colliders.0.resolution=64`.\n"
        "A value outside its range is an error. A vector's range holds for each component. Fixed: takes effect when the scene is "
        "loaded.\n\n"
        "| path | unit | range | default | what it is |\n"
        "| --- | --- | --- | --- | --- |\n";
    for (const ParamEntry& entry : listParams(visit)) {
        const bool single = entry.kind == ParamEntry::Kind::value;
        const std::string path = single ? fmt::format("`{}`", entry.path) : fmt::format("**{}**", entry.path);
        const std::string text = entry.text.empty() ? "" : fmt::format("`{}`", entry.text);
        page += fmt::format("| {} | {} | {} | {} | {}{} |\n", path, entry.unit, tableCell(entry.range), tableCell(text),
                            tableCell(entry.doc), entry.fixed ? " (fixed)" : "");
    }
    return page;
}

}  // namespace rivulet
