// Contacts of bodies for a GPU: in pairs, the pairs in colours, and each contact with the one that it was in the frame before.
#pragma once

#include <span>
#include <vector>

#include "engine/core/math.h"
#include "fluid/sim/solids/bodies.h"
#include "shaders/fluid/solids/body_contact_rows.h"

namespace rivulet {

// What advance_touching reads.
struct ContactRows {
    std::vector<ContactPair> pairs;    // sorted by colour; no two of a colour have a body in common that moves
    std::vector<ContactRow> contacts;  // in the order of pairs
    std::vector<uint32_t> colours;     // the first pair of each, and the number of pairs
    std::vector<uint32_t> slots;       // of each body, NO_SLOT where it has no contact
    uint32_t touching = 0;             // bodies with a slot
    uint32_t colourCount() const { return colours.empty() ? 0 : static_cast<uint32_t>(colours.size()) - 1; }
};

// `before`: those of the frame before, empty if there were none. `moves`: of each body, whether it has mass. A contact of the same two
// bodies that was within `near` (m) is the same; of several, the nearest. The nearest takes over the impulses of those that are gone.
ContactRows contactRows(std::span<const BodyContact> contacts, const std::vector<bool>& moves, const ContactRows& before, float near);

// Of contacts with one normal those that imply the others: the corners of what they span, without ones that stand out by less than `flat`
// (m). All of them where the separations (m) are not those of two planes, within `flat`. Returns their places, in order.
std::vector<size_t> outlineOf(std::span<const vec3> places, std::span<const float> separations, const vec3& normal, float flat);

// At most `most` of a pair's contacts: the deepest, and of the others those that are farthest from the ones chosen. `separations`, m.
// Returns their places, the deepest first.
std::vector<size_t> spreadOf(std::span<const vec3> places, std::span<const float> separations, size_t most);

}  // namespace rivulet
