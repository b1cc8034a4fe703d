#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "engine/core/file.h"
#include "engine/core/json.h"
#include "engine/core/json_parse.h"
#include "engine/core/param_path.h"
#include "engine/core/param_value.h"

namespace rivulet {

namespace {

constexpr size_t kLargestFile = size_t{64} << 20U;

// Reads the JSON tree while the struct is visited. The first error is kept, and nothing is read after it.
class JsonReader final : public ParamVisitor {
  public:
    JsonReader(const Json::Value& root, std::string_view text, std::string_view file, const VisitFn& visit)
        : text_(text), file_(file), visit_(visit) {
        enter(&root, "");
    }

    Status read() {
        visit_(*this);
        leave();
        return error_ ? Status(*error_) : ok();
    }

    void value(const ParamInfo& info, float& v) override { assign(info, v); }
    void value(const ParamInfo& info, int& v) override { assign(info, v); }
    void value(const ParamInfo& info, bool& v) override { assign(info, v); }
    void value(const ParamInfo& info, vec3& v) override { assign(info, v); }
    void colour(const ParamInfo& info, vec3& v) override { assign(info, v); }
    void value(const ParamInfo& info, std::string& v) override {
        if (const Json::Value* text = textMember(info)) v = text->asString();
    }
    void choice(const ParamInfo& info, std::string& v, std::span<const std::string> names) override {
        if (const Json::Value* text = textMember(info)) refuseIf(*text, info, assignChoice(text->asString(), v, names));
    }

  protected:
    bool beginGroup(const ParamInfo& info) override {
        const Json::Value* object = member(info);
        if (object == nullptr) return false;
        enter(object, pathOf(levels_.back().path, info.name));
        return true;
    }
    void endGroup() override { leave(); }

    size_t beginList(const ParamInfo& info, size_t current) override {
        const Json::Value* array = member(info);
        const std::string path = pathOf(levels_.back().path, info.name);
        if (array != nullptr && !array->isArray()) {
            refuse(array->getOffsetStart(), fmt::format("{} is {}, must be a list [...]", path, excerpt(sourceOf(*array))));
            array = nullptr;
        }
        lists_.push_back({array, path});
        return array == nullptr ? current : array->size();
    }
    void beginItem(size_t index) override {
        const List& list = lists_.back();
        enter(list.array == nullptr ? nullptr : &(*list.array)[static_cast<Json::ArrayIndex>(index)], pathOf(list.path, index));
    }
    void endItem() override { leave(); }
    void endList() override { lists_.pop_back(); }

  private:
    struct Level {
        const Json::Value* object;  // null: the file does not have this group, or an error was found
        std::string path;
        std::vector<std::string> known;
    };
    struct List {
        const Json::Value* array;
        std::string path;
    };

    std::string sourceOf(const Json::Value& v) const {
        const auto start = static_cast<size_t>(v.getOffsetStart());
        return std::string(text_.substr(start, static_cast<size_t>(v.getOffsetLimit()) - start));
    }

    void refuse(ptrdiff_t offset, const std::string& complaint) {
        if (!error_) error_ = badInput(fmt::format("{}{}: {}", file_, placeOf(text_, static_cast<size_t>(offset)), complaint));
    }

    void refuseIf(const Json::Value& v, const ParamInfo& info, const std::string& complaint) {
        if (!complaint.empty()) refuse(v.getOffsetStart(), pathOf(levels_.back().path, info.name) + " " + complaint);
    }

    // The value in the file, or null if it has none.
    const Json::Value* member(const ParamInfo& info) {
        Level& level = levels_.back();
        level.known.emplace_back(info.name);
        if (error_ || level.object == nullptr) return nullptr;
        return level.object->find(info.name, info.name + std::string_view(info.name).size());
    }

    const Json::Value* textMember(const ParamInfo& info) {
        const Json::Value* text = member(info);
        if (text == nullptr || text->isString()) return text;
        refuseIf(*text, info, fmt::format("is {}, must be text in double quotes", excerpt(sourceOf(*text))));
        return nullptr;
    }

    template <class T>
    void assign(const ParamInfo& info, T& v) {
        if (const Json::Value* found = member(info)) refuseIf(*found, info, assignValue(info, sourceOf(*found), v));
    }

    void enter(const Json::Value* object, std::string path) {
        if (object != nullptr && !object->isObject()) {
            const std::string name = path.empty() ? "the file's outermost value" : path;
            refuse(object->getOffsetStart(), fmt::format("{} is {}, must be an object {{...}}", name, excerpt(sourceOf(*object))));
            object = nullptr;
        }
        levels_.push_back({object, std::move(path), {}});
    }

    // At this point the visit has named all valid keys of the object.
    void leave() {
        const Level level = std::move(levels_.back());
        levels_.pop_back();
        if (error_ || level.object == nullptr) return;
        std::map<ptrdiff_t, std::string> unknown;  // by offset, so that the first one in the file is reported
        for (const std::string& key : level.object->getMemberNames())
            if (std::find(level.known.begin(), level.known.end(), key) == level.known.end())
                unknown.emplace(keyOffset(*level.object->find(key.data(), key.data() + key.size())), key);
        if (!unknown.empty()) refuse(unknown.begin()->first, unknownParam(level.path, unknown.begin()->second, level.known, visit_));
    }

    // JsonCpp stores the offset of a value only; its key is the string in front of the colon.
    ptrdiff_t keyOffset(const Json::Value& v) const {
        const size_t closing = text_.rfind('"', text_.rfind(':', static_cast<size_t>(v.getOffsetStart()) - 1));
        size_t opening = text_.rfind('"', closing - 1);
        while (escaped(opening)) opening = text_.rfind('"', opening - 1);
        return static_cast<ptrdiff_t>(opening);
    }

    bool escaped(size_t at) const {
        size_t backslashes = 0;
        while (backslashes < at && text_[at - 1 - backslashes] == '\\') ++backslashes;
        return backslashes % 2 == 1;
    }

    std::string_view text_, file_;
    const VisitFn& visit_;
    std::vector<Level> levels_;
    std::vector<List> lists_;
    std::optional<Error> error_;
};

}  // namespace

Status readJson(std::string_view text, std::string_view file, const VisitFn& visit) {
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // the byte order mark that some editors put first
    Result<Json::Value> root = parseJson(text, file);
    if (!root) return root.error();
    return JsonReader(*root, text, file, visit).read();
}

Status readJsonFile(const std::string& path, const VisitFn& visit) {
    Result<std::string> text = readFile(path, kLargestFile);
    if (!text) return text.error();
    return readJson(*text, path, visit);
}

}  // namespace rivulet
