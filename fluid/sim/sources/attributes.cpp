#include "fluid/sim/sources/attributes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace rivulet {

namespace {

template <class Attribute>
const Attribute* find(std::span<const Attribute> among, const std::string& name) {
    const auto at = std::ranges::find(among, name, &Attribute::name);
    return at == among.end() ? nullptr : &*at;
}

template <class Attribute>
Status checkNames(std::span<const AttributeParams> all, std::span<const Attribute> own, const std::string& where) {
    for (size_t k = 0; k < own.size(); ++k) {
        if (find(all, own[k].name) == nullptr) {
            std::vector<std::string> names;
            for (const AttributeParams& a : all) names.push_back(a.name);
            return badInput(fmt::format("{}.attributes[{}].name is '{}', and fluid.attributes has {}: add it there", where, k, own[k].name,
                                        names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
        }
        if (find(own.first(k), own[k].name) != nullptr)
            return badInput(fmt::format("{}.attributes has '{}' twice: remove one", where, own[k].name));
    }
    return ok();
}

template <class Attribute>
vec4 valueOf(const AttributeParams& of, std::span<const Attribute> own) {
    const Attribute* found = find(own, of.name);
    return found != nullptr ? found->value() : of.value();
}

}  // namespace

Status checkAttributes(std::span<const AttributeParams> all, std::span<const AttributeParams> own, const std::string& where) {
    return checkNames(all, own, where);
}
Status checkAttributes(std::span<const AttributeParams> all, std::span<const LiveAttributeParams> own, const std::string& where) {
    return checkNames(all, own, where);
}

Status checkAttributes(const FluidParams& params) {
    const std::span<const AttributeParams> all(params.attributes);
    if (all.size() > kMostAttributes)
        return badInput(
            fmt::format("fluid.attributes has {}, and {} are possible: put up to four numbers into one", all.size(), kMostAttributes));
    for (size_t k = 0; k < all.size(); ++k) {
        if (all[k].name.empty()) return badInput(fmt::format("fluid.attributes[{}].name is empty: give it a name", k));
        if (find(all.first(k), all[k].name) != nullptr)
            return badInput(fmt::format("fluid.attributes has '{}' twice: give each its own name", all[k].name));
    }
    for (size_t k = 0; k < params.blocks.size(); ++k)
        if (Status s = checkNames(all, std::span<const AttributeParams>(params.blocks[k].attributes), fmt::format("fluid.blocks[{}]", k));
            !s)
            return s;
    return ok();
}

vec4 attributeOf(const AttributeParams& of, std::span<const AttributeParams> own) { return valueOf(of, own); }
vec4 attributeOf(const AttributeParams& of, std::span<const LiveAttributeParams> own) { return valueOf(of, own); }

}  // namespace rivulet
