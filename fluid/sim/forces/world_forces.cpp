#include "fluid/sim/forces/world_forces.h"

#include <fmt/format.h>

#include <algorithm>

namespace rivulet {

namespace {

std::string linkedWithout(const std::string& force, const std::string& remedy) {
    return fmt::format("fluid.grid linked_list does not support the force '{}': {}, or choose fluid.grid sorted", force, remedy);
}

}  // namespace

Result<WorldForces> WorldForces::create(std::span<const HostForce> hosts) {
    WorldForces made;
    made.hosts_.assign(hosts.begin(), hosts.end());
    for (const HostForce& f : made.hosts_) {
        if (f.make == nullptr) return badInput(fmt::format("the host's force '{}' has no function make: give it one", f.name));
        for (const Entry& other : made.entries_)
            if (other.name == f.name) return badInput(fmt::format("the host has two forces '{}': give each a name of its own", f.name));
        if (forces().find(f.name) != nullptr)
            return badInput(fmt::format("there is a force '{}' already: give the host's another name", f.name));
        made.entries_.push_back({f.name,
                                 "turn it off",
                                 [f](const FluidParams& p, bool) { return f.on == nullptr || f.on(f.self, p); },
                                 [f](Device& d, const MethodSetup& setup) { return f.make(f.self, d, setup); },
                                 {},
                                 false,
                                 true});
    }
    for (const ForceRow& force : forces().rows)
        made.entries_.push_back({force.name, force.remedy, force.on, force.make, {}, false, force.keepsAwake});
    return made;
}

Status WorldForces::refuseForLinkedLists(const FluidParams& params, bool doesViscosity) const {
    for (const Entry& f : entries_)
        if (f.wanted(params, doesViscosity)) return badInput(linkedWithout(f.name, f.remedy));
    return ok();
}

Result<std::vector<std::string>> WorldForces::update(Device& device, const MethodSetup& setup) {
    std::vector<std::string> off;
    for (Entry& f : entries_) {
        f.on = f.wanted(setup.params, setup.doesViscosity);
        if (f.on && setup.traits.linked) {  // turned on later: create() refused what was on
            off.push_back(linkedWithout(f.name, f.remedy));
            f.on = false;
        }
        if (!f.on || f.pass) continue;
        Result<ForcePass> made = f.make(device, setup);
        if (!made && made.error().memory)
            return noMemory(fmt::format("the force '{}' has not enough memory: {}; or {}", f.name, made.error().message, f.remedy));
        if (made)
            f.pass = std::move(*made);
        else
            off.push_back(made.error().message);
        f.on = static_cast<bool>(made);
    }
    return off;
}

bool WorldForces::anyOn() const {
    return std::any_of(entries_.begin(), entries_.end(), [](const Entry& f) { return f.on; });
}

const char* WorldForces::keepsAwake() const {
    for (const Entry& f : entries_)
        if (f.on && f.keepsAwake) return f.name.c_str();
    return nullptr;
}

void WorldForces::run(StepContext& context) const {
    for (const Entry& f : entries_)
        if (f.on) f.pass(context);
}

float WorldForces::pressure(const FluidParams& params) const {
    float most = 0;
    for (const ForceRow& f : forces().rows)
        if (f.pressure != nullptr) most = std::max(most, f.pressure(params));
    return most;
}

float WorldForces::fastest(const FluidParams& params) const {
    float fastest = 0;
    for (const ForceRow& f : forces().rows)
        if (f.fastest != nullptr) fastest = std::max(fastest, f.fastest(params));
    for (const HostForce& f : hosts_)
        if (f.fastest != nullptr) fastest = std::max(fastest, f.fastest(f.self));
    return fastest;
}

void WorldForces::visit(ParamVisitor& v) const {
    struct Own {
        const HostForce& force;
        void visit(ParamVisitor& visitor) { force.visit(force.self, visitor); }
    };
    for (const HostForce& f : hosts_) {
        Own own{f};
        if (f.visit != nullptr) v.group({.name = f.name, .doc = f.doc}, own);
    }
}

}  // namespace rivulet
