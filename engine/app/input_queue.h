// InputQueue: input events in their order, divided into frames so that none is lost in a long frame: press and release of a click go to
// two frames, each at the position of the pointer.
#pragma once

#include <deque>
#include <string>

#include "engine/app/input_events.h"

namespace rivulet {

// A key by what it prints (UTF-8 without shift; null: nothing), where `code` is what it is on a US keyboard: as InputEvents has keys.
int keyOf(int code, const char* prints);

class InputQueue {
  public:
    void move(const vec2& to) { add({.kind = Kind::move, .at = to}); }  // window coordinates
    void button(MouseButton which, bool down) { add({.kind = Kind::button, .code = static_cast<int>(which), .down = down}); }
    void key(int which, bool down) { add({.kind = Kind::key, .code = which, .down = down}); }
    void type(std::string utf8) { add({.kind = Kind::text, .text = std::move(utf8)}); }
    void wheel(const vec2& steps) { add({.kind = Kind::wheel, .at = steps}); }
    void drop(std::string path) { add({.kind = Kind::drop, .text = std::move(path)}); }

    // The next frame's: from the oldest on, as much as happens together. What is held, and where the pointer is, `events` has from the
    // frame before.
    void take(InputEvents& events);
    bool empty() const { return waiting_.empty(); }

  private:
    enum class Kind { move, button, key, text, wheel, drop };
    struct Event {
        Kind kind = Kind::move;
        vec2 at{0.0F};
        int code = 0;
        bool down = false;
        std::string text = {};
    };
    void add(Event event) { waiting_.push_back(std::move(event)); }

    std::deque<Event> waiting_;
};

}  // namespace rivulet
