// Params: a plain struct with one function `visit(ParamVisitor&)`, which states name, unit, range, default and doc of each value once.
// JSON reading and writing, ImGui sliders, --set, the generated reference and the record of a run all use it.
//
//     struct CameraParams {
//         float fieldOfView = 45;
//         vec3 target{0};
//         void visit(ParamVisitor& v) {
//             v.value({"fieldOfView", "deg", "vertical angle of view", 5, 120}, fieldOfView);
//             v.value({"target", "m", "the point looked at", -1e4, 1e4}, target);
//         }
//     };
//
// The default is the value in a default-constructed struct. A list is a vector of such structs; a group is a nested struct.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/core/math.h"

namespace rivulet {

// Values of ParamInfo's last members, and the farthest position.
inline constexpr bool kLog = true, kLinear = false;
inline constexpr bool kFixed = true;
inline constexpr double kMaxPosition = 1.0e5;  // m; beyond this float32 no longer tells millimetres apart

// The range is inclusive, in `unit`, and applies to each component; a value outside is an error and is never clamped.
struct ParamInfo {
    const char* name;
    const char* unit = "";  // "": dimensionless
    const char* doc = "";   // one phrase, lower case, no full stop
    double min = -1e30;
    double max = 1e30;
    bool logarithmic = false;  // the slider's scale
    bool fixed = false;        // takes effect only when the world is created again; panels show this
};

class ParamVisitor {
  public:
    virtual ~ParamVisitor() = default;
    virtual void value(const ParamInfo& info, float& v) = 0;
    virtual void value(const ParamInfo& info, int& v) = 0;
    virtual void value(const ParamInfo& info, bool& v) = 0;
    virtual void value(const ParamInfo& info, std::string& v) = 0;
    virtual void value(const ParamInfo& info, vec3& v) = 0;
    virtual void colour(const ParamInfo& info, vec3& v) = 0;  // linear RGB
    virtual void choice(const ParamInfo& info, std::string& v, std::span<const std::string> names) = 0;

    template <class P>
    void group(const ParamInfo& info, P& params) {
        if (!beginGroup(info)) return;
        params.visit(*this);
        endGroup();
    }
    template <class P>
    void list(const ParamInfo& info, std::vector<P>& items) {
        size_t count = beginList(info, items.size());
        items.resize(count);
        for (size_t i = 0; i < count; ++i) {
            beginItem(i);
            items[i].visit(*this);
            endItem();
        }
        if (documentsItems() && items.empty()) {  // the reference describes an item even if the default list is empty
            P item;
            beginItem(0);
            item.visit(*this);
            endItem();
        }
        endList();
    }

  protected:
    virtual bool beginGroup(const ParamInfo& info) = 0;  // false: the group is skipped and endGroup is not called
    virtual void endGroup() = 0;
    virtual size_t beginList(const ParamInfo& info, size_t current) = 0;  // returns the new length
    virtual void beginItem(size_t index) = 0;
    virtual void endItem() = 0;
    virtual void endList() = 0;
    virtual bool documentsItems() const { return false; }
};

}  // namespace rivulet
