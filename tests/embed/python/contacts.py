"""contacts.py: a body_host in Python by whose contacts a GPU moves a ball: it lies on the floor, and advance is called only where contacts returns
None. Exit 77: there is no OpenCL."""
import sys

import numpy as np
import rivulet

from refusals import refused


class Floor:
    radius, moved, passes, predicted, raises = 0.06, 0, 0, 0, None
    gives = "floor"

    def advance(self, loads, gravity, seconds, states):
        self.moved += 1

    def reset(self, states):
        pass

    def contacts(self, states, balls, seconds):
        assert balls.shape == (len(states), 4) and seconds > 0
        if self.raises == "contacts":
            raise KeyError("contacts")
        if not isinstance(self.gives, str):
            return self.gives
        low = np.flatnonzero(balls[:, 1] - balls[:, 3] <= self.radius)
        found = np.zeros(len(low), rivulet.CONTACT)
        found["a"], found["b"], found["radius_a"], found["normal"][:, 1] = low, rivulet.SOLID, self.radius, 1
        found["on_b"][:, [0, 2]] = states["position"][low][:, [0, 2]]
        return found

    def passed(self, seconds):
        self.passes += 1

    def predict(self, loads, gravity, start, seconds, states):
        if self.raises == "predict":
            raise KeyError("predict")
        self.predicted += 1
        states["position"][:, 1] = np.maximum(states["position"][:, 1] + states["velocity"][:, 1] * seconds, self.radius)


round_ = np.random.default_rng(0).normal(size=(60, 3))
ball = rivulet.Body(0.045 * round_ / np.linalg.norm(round_, axis=1, keepdims=True), 2, (0.003,) * 3, 9e-4, (0.3, 0.1, 0.3))
shallow = {"fluid": {"spacing": 0.03, "box": {"max": [0.6, 1, 0.6]}, "blocks": [{"max": [0.6, 0.06, 0.6]}]}}
try:
    device = rivulet.Context(backend="cl")
except rivulet.Error as error:
    print("no device of OpenCL:", error)
    sys.exit(77)
with device:
    for left_out, words in (("passed", "one of contacts and passed"), ("contacts", "one of contacts and passed")):
        some = Floor()
        setattr(some, left_out, None)
        refused(lambda: device.world(shallow, bodies=[ball], body_host=some), words)
    some.passed = None
    refused(lambda: device.world(shallow, bodies=[ball], body_host=some), "has predict, and neither contacts nor passed")
    some.predict = 3
    refused(lambda: device.world(shallow, bodies=[ball], body_host=some), "body_host.predict is 3: give a function")
    floor = Floor()
    with device.world(shallow, bodies=[ball], body_host=floor) as world:
        def height():
            return world.bodies()["position"][0, 1]

        for _ in range(30):
            world.step(1 / 60)
        assert abs(height() - 0.06) < 0.003 and floor.passes > 30 and floor.predicted > 0 and floor.moved == 0, (height(), vars(floor))
        for name in ("contacts", "predict"):
            before, floor.raises = world.bodies(), name
            try:
                world.step(1 / 60)
                raise AssertionError("what the host raised was lost")
            except KeyError as error:
                assert name in str(error)
            floor.raises = None
            assert (world.bodies() == before).all()
            world.step(1 / 60)
        moved, floor.gives = floor.moved, None
        world.step(1 / 60)
        assert floor.moved > moved
        floor.gives = np.zeros(1, rivulet.CONTACT)
        refused(lambda: world.step(1 / 60), "a contact of body 0 with itself", kind=rivulet.Error)
        passes, floor.gives = floor.passes, []
        world.step(1 / 60)
        assert floor.passes > passes and height() < 0.06  # nothing holds it
