// A widget for every Param: a slider, drag field, check box, combo, colour editor or text field with name, unit and doc from its visit().
//
//     ParamPanel panel(memory);
//     panel.search([&](ParamVisitor& v) { scene.visit(v); });  // inside an ImGui window; the field that looks for names
//     scene.visit(panel);
//     if (panel.recreate()) ...                                // a value that needs a new world was let go of
//     else if (panel.changed()) world.setParams(scene.fluid);
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "engine/core/json.h"
#include "engine/core/params.h"

namespace rivulet {

// The state of a parameter panel between frames: the search text, and each value as it was opened.
class ParamMemory {
  public:
    // A reset goes back to these values; `defaults`: a visit over default values.
    void open(const VisitFn& params, const VisitFn& defaults);
    // After an edit: finds the changed values.
    void compare(const VisitFn& params);
    const std::map<std::string, std::string>& changed() const { return changed_; }  // path: its value as opened, in JSON
    const std::string* byDefault(const std::string& path) const;                    // in JSON; null: there is none of that name

    std::string wanted;  // words, any of them in any case; all must be in a Param's path, name or doc. "": all are shown
    bool find = false;   // the next search() takes the keyboard

  private:
    std::map<std::string, std::string> opened_, defaults_, changed_;
};

class ParamPanel final : public ParamVisitor {
  public:
    explicit ParamPanel(ParamMemory& memory) : memory_(memory) {}
    // The search field, the number of changed values, and a button that resets them. Before the visit.
    void search(const VisitFn& params);
    bool changed() const { return changed_; }    // a value was changed
    bool recreate() const { return recreate_; }  // a `fixed` value's edit ended, or a list's length changed

    void value(const ParamInfo& info, float& v) override;
    void value(const ParamInfo& info, int& v) override;
    void value(const ParamInfo& info, bool& v) override;
    void value(const ParamInfo& info, std::string& v) override;
    void value(const ParamInfo& info, vec3& v) override;
    void colour(const ParamInfo& info, vec3& v) override;
    void choice(const ParamInfo& info, std::string& v, std::span<const std::string> names) override;

  protected:
    bool beginGroup(const ParamInfo& info) override;
    void endGroup() override;
    size_t beginList(const ParamInfo& info, size_t current) override;
    void beginItem(size_t index) override;
    void endItem() override;
    void endList() override;

  private:
    bool hidden() const { return closed_ > 0; }  // inside a list or item that is folded
    bool shown(const char* name) const;          // of a value, group or list, while something is searched for
    void find(const VisitFn& params);
    bool isWhole(const std::string& path) const;
    void resetAll(const VisitFn& params);
    void label(const ParamInfo& info, std::string& text);  // `text`: in JSON, a value that its menu chose; else as it was
    template <class Widget, class Take>
    void edit(const ParamInfo& info, const Widget& widget, const Take& take);
    bool unfolded(const std::string& title);
    bool floats(const ParamInfo& info, float* v, int count);

    ParamMemory& memory_;
    std::set<std::string> found_;     // paths of what is searched for, with the groups and lists on the way
    std::vector<std::string> whole_;  // groups and lists that were themselves found
    std::vector<std::string> paths_;  // of the groups and items on the way, the innermost last
    std::vector<std::string> lists_;  // of the lists on the way
    bool changed_ = false, recreate_ = false;
    int depth_ = 0;   // groups and items open
    int closed_ = 0;  // of the enclosing lists and items, folded
    std::vector<bool> open_;
};

// Whether a slider of this range is logarithmic: where the Param says so, or the range spans three decades; not over more than eight.
bool slidesByDecades(const ParamInfo& info);

// "artificialViscosity" -> "artificial viscosity".
std::string readableName(std::string_view name);

}  // namespace rivulet
