// A widget for every Param: a slider, drag field, check box, combo, colour editor or text field with name, unit and doc from its visit().
//
//     ParamPanel panel;
//     scene.visit(panel);                       // inside an ImGui window
//     if (panel.recreate()) ...                 // a value that needs a new world was let go of
//     else if (panel.changed()) world.setParams(scene.fluid);
#pragma once

#include <string>
#include <vector>

#include "engine/core/params.h"

namespace rivulet {

class ParamPanel final : public ParamVisitor {
  public:
    ParamPanel();
    bool changed() const { return changed_; }    // some value is another one now
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
    void label(const ParamInfo& info);
    void settle(const ParamInfo& info, bool edited);  // after the widget
    bool floats(const ParamInfo& info, float* v, int count);

    bool changed_ = false, recreate_ = false;
    int depth_ = 0;   // groups and items open
    int closed_ = 0;  // of the enclosing lists and items, folded
    std::vector<bool> open_;
};

// "artificialViscosity" -> "artificial viscosity".
std::string readableName(std::string_view name);

}  // namespace rivulet
