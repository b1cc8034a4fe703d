#include "engine/app/input_queue.h"

#include <utility>

namespace rivulet {

int keyOf(int code, const char* prints) {
    if (prints == nullptr || prints[0] <= ' ' || prints[0] > '~' || prints[1] != 0) return code;
    const char c = prints[0];
    return c >= 'a' && c <= 'z' ? c - 'a' + 'A' : c;
}

void InputQueue::take(InputEvents& e) {
    std::fill(std::begin(e.buttonPressed), std::end(e.buttonPressed), false);
    std::fill(std::begin(e.buttonReleased), std::end(e.buttonReleased), false);
    e.wheel = vec2(0.0F);
    e.keysPressed.clear();
    e.text.clear();
    e.dropped.clear();
    const vec2 before = e.mouse;
    bool moved = false, clicked = false;
    bool together = false;  // a key went down with control or alt: what follows may be for what that opens
    for (; !waiting_.empty(); waiting_.pop_front()) {
        Event& next = waiting_.front();
        if (next.kind == Kind::move) {
            if (clicked) break;
            e.mouse = next.at;
            moved = true;
        } else if (next.kind == Kind::button) {
            const int b = next.code;
            if (e.buttonPressed[b] || e.buttonReleased[b]) break;
            if (!next.down && moved && e.buttonDown[b]) break;  // a drag's end is seen with the button held
            e.buttonDown[b] = next.down;
            (next.down ? e.buttonPressed : e.buttonReleased)[b] = clicked = true;
        } else if (next.kind == Kind::key) {
            if (together || (next.down && clicked)) break;
            std::erase(e.keysDown, next.code);
            if (!next.down) continue;
            together = e.down(key::kLeftControl) || e.down(key::kRightControl) || e.down(key::kLeftAlt);
            e.keysDown.push_back(next.code);
            e.keysPressed.push_back(next.code);
        } else if (next.kind == Kind::text) {
            if (together || clicked) break;
            e.text += next.text;
        } else if (next.kind == Kind::wheel) {
            e.wheel += next.at;
        } else {
            e.dropped.push_back(std::move(next.text));
        }
    }
    e.mouseDelta = e.mouse - before;
}

}  // namespace rivulet
