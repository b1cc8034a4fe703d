// The forces of one world: the rows of forces() and the host's own, which of them are on, and their passes.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "fluid/sim/forces/force.h"

namespace rivulet {

class WorldForces {
  public:
    // The host's forces run first, the rows of forces() after them. Error (badInput): a host's force without make, or with a name that
    // another force has.
    static Result<WorldForces> create(std::span<const HostForce> hosts);

    // fluid.grid linked_list supports no force. Error (badInput): the first that these Params turn on, and how to turn it off.
    Status refuseForLinkedLists(const FluidParams& params, bool doesViscosity) const;
    // Makes the passes of what is on from now. Returns a sentence for each force that has to stay off. Error (noMemory): for one of them;
    // those made before it are kept.
    Result<std::vector<std::string>> update(Device& device, const MethodSetup& setup);
    bool anyOn() const;
    const char* keepsAwake() const;  // the name of an active force with ForceRow::keepsAwake; null: there is none
    void run(StepContext& context) const;
    float fastest(const FluidParams& params) const;   // m/s, the most that a force drives water to
    float pressure(const FluidParams& params) const;  // Pa, the most that a force causes inside the fluid
    void visit(ParamVisitor& v) const;                // the Params of the host's forces, a group each

  private:
    struct Entry {
        std::string name, remedy;
        std::function<bool(const FluidParams& params, bool doesViscosity)> wanted;
        std::function<Result<ForcePass>(Device& device, const MethodSetup& setup)> make;
        ForcePass pass = {};  // made when it is first on
        bool on = false, keepsAwake = false;
    };
    std::vector<HostForce> hosts_;
    std::vector<Entry> entries_;
};

}  // namespace rivulet
