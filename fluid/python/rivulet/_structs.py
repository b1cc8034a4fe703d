"""The structs of rivulet.h for ctypes, member by member, and those without `size` as types of NumPy. A test compares them with the headers."""
from __future__ import annotations

import ctypes
from ctypes import POINTER, Structure, c_char_p, c_double, c_float, c_int, c_int32, c_size_t, c_uint32, c_uint64, c_void_p

import numpy as np

LOG = ctypes.CFUNCTYPE(None, c_void_p, c_int, c_char_p)
FIND = ctypes.CFUNCTYPE(c_void_p, c_char_p)
ADVANCE = ctypes.CFUNCTYPE(None, c_void_p, c_void_p, POINTER(c_float * 3), c_double, c_void_p, c_size_t)
RESET = ctypes.CFUNCTYPE(None, c_void_p, c_void_p, c_size_t)
ADDED = ctypes.CFUNCTYPE(None, c_void_p, c_uint32, c_void_p)
REMOVED = ctypes.CFUNCTYPE(None, c_void_p, c_uint32)
ADD_CONTACT = ctypes.CFUNCTYPE(None, c_void_p, c_void_p)
CONTACTS = ctypes.CFUNCTYPE(c_int32, c_void_p, c_void_p, c_void_p, c_size_t, c_double, ADD_CONTACT, c_void_p)
PASSED = ctypes.CFUNCTYPE(None, c_void_p, c_double)
PREDICT = ctypes.CFUNCTYPE(None, c_void_p, c_void_p, POINTER(c_float * 3), c_double, c_double, c_void_p, c_size_t)
SAMPLES = ctypes.CFUNCTYPE(None, c_void_p, c_void_p, c_size_t)
LINE = ctypes.CFUNCTYPE(None, c_void_p, c_int32, c_size_t, POINTER(c_float * 3), POINTER(c_float * 3))

POSE = np.dtype([("position", np.float32, 3), ("rotation", np.float32, 4)])
STATE = np.dtype(POSE.descr + [("velocity", np.float32, 3), ("spin", np.float32, 3)])
LOAD = np.dtype([("force", np.float64, 3), ("torque", np.float64, 3)])
# rivulet_body_contact, and what a caller fills of it.
CONTACT_ROW = np.dtype([("size", np.uintp), ("a", np.uint32), ("b", np.uint32), ("on_a", np.float32, 3), ("on_b", np.float32, 3),
                        ("radius_a", np.float32), ("radius_b", np.float32), ("normal", np.float32, 3), ("velocity_b", np.float32, 3),
                        ("spin_b", np.float32, 3), ("centre_b", np.float32, 3), ("seconds_b", np.float64), ("friction", np.float32),
                        ("restitution", np.float32)])
CONTACT = np.dtype(CONTACT_ROW.descr[1:])
SOLID = 0x7fffffff
SAMPLE = np.dtype([("density", np.float32), ("velocity", np.float32, 3), ("gradient", np.float32, 3)])
RAY = np.dtype([("origin", np.float32, 3), ("direction", np.float32, 3), ("reach", np.float32)])
HIT = np.dtype([("hit", np.uint32), ("inside", np.uint32), ("distance", np.float32), ("place", np.float32, 3), ("normal", np.float32, 3),
                ("velocity", np.float32, 3)])
HIT_RESULT = np.dtype([("hit", bool), ("inside", bool)] + HIT.descr[2:])
VOLUME = np.dtype([("id", np.uint32), ("shape", np.int32), ("position", np.float32, 3), ("size", np.float32, 3), ("radius", np.float32)])
COUNT = np.dtype([("id", np.uint32), ("entered", np.uint64), ("left", np.uint64), ("inside", np.uint64), ("time", np.float64),
                  ("volume_inside", np.float64)], align=True)
MOST_VOLUMES = 32
MOST_ATTRIBUTES = 4
LOADS = np.dtype([("name", "S64"), ("time", np.float64), ("seconds", np.float64), ("force", np.float64, 3), ("torque", np.float64, 3),
                  ("pressure", np.float64), ("impulse", np.float64, 3), ("angular_impulse", np.float64, 3)])
LIGHT = np.dtype([("direction", np.float32, 3), ("colour", np.float32, 3)])
LINE_RESULT = np.dtype([("part", "U8"), ("index", np.uint64), ("start", np.float32, 3), ("end", np.float32, 3)])


class Why(Structure):
    _fields_ = [("message", ctypes.c_char * 1024)]


class ContextOptions(Structure):
    _fields_ = [("size", c_size_t), ("find", c_void_p), ("backend", c_char_p), ("device", c_char_p), ("log", LOG), ("log_user", c_void_p),
                ("memory_limit", c_size_t), ("sky_horizon", c_float * 3), ("sky_zenith", c_float * 3), ("sky_sun", c_float * 3),
                ("clouds", c_float), ("threads", c_int32), ("jobs", c_void_p), ("memory", c_void_p), ("plain_state", c_uint32)]


class PassTime(Structure):
    _fields_ = [("name", ctypes.c_char * 64), ("ms", c_double), ("calls", c_int32)]


class Pose(Structure):
    _fields_ = [("position", c_float * 3), ("rotation", c_float * 4)]


class Mesh(Structure):
    _fields_ = [("size", c_size_t), ("positions", c_void_p), ("vertices", c_size_t), ("indices", c_void_p), ("indices_count", c_size_t),
                ("uvs", c_void_p), ("friction", c_float), ("restitution", c_float), ("moves", c_uint32), ("resolution", c_int32),
                ("pose", Pose), ("reach_low", c_float * 3), ("reach_high", c_float * 3), ("layers", c_uint32), ("meets", c_uint32)]


class Body(Structure):
    _fields_ = [("size", c_size_t), ("samples", c_void_p), ("samples_count", c_size_t), ("mass", c_float), ("inertia", c_float * 3),
                ("volume", c_float), ("pose", Pose), ("mesh", POINTER(Mesh)), ("density", c_float), ("velocity", c_float * 3),
                ("spin", c_float * 3), ("layers", c_uint32), ("meets", c_uint32)]


class BodyState(Structure):
    _fields_ = [("pose", Pose), ("velocity", c_float * 3), ("spin", c_float * 3)]


class BodyHost(Structure):
    _fields_ = [("size", c_size_t), ("user", c_void_p), ("advance", ADVANCE), ("reset", RESET), ("added", ADDED), ("removed", REMOVED),
                ("contacts", CONTACTS), ("passed", PASSED), ("predict", PREDICT)]


class WorldOptions(Structure):
    _fields_ = [("size", c_size_t), ("json", c_char_p), ("walls", POINTER(Mesh)), ("walls_count", c_size_t), ("bodies", POINTER(Body)),
                ("bodies_count", c_size_t), ("body_host", POINTER(BodyHost)), ("particles", c_void_p), ("particle_velocities", c_void_p),
                ("particles_count", c_size_t), ("skins_bring", c_double)]


class Inputs(Structure):
    _fields_ = [("size", c_size_t), ("gravity", c_void_p), ("poses", c_void_p), ("poses_count", c_size_t), ("shapes", POINTER(c_void_p)),
                ("shapes_count", c_size_t)]


class Stats(Structure):
    _fields_ = [("size", c_size_t), ("time", c_double), ("dropped", c_double), ("particles", c_uint32), ("lost", c_uint32),
                ("average_compression", c_double), ("kinetic", c_double), ("potential", c_double), ("maximum_speed", c_double),
                ("centre_of_mass", c_double * 3), ("substeps", c_int32), ("asleep", c_uint32)]


class Particles(Structure):
    _fields_ = [("size", c_size_t), ("capacity", c_size_t), ("positions", c_void_p), ("velocities", c_void_p), ("densities", c_void_p),
                ("ids", c_void_p), ("count", c_size_t), ("attributes", c_void_p * MOST_ATTRIBUTES)]


class Rows(Structure):
    _fields_ = [("size", c_size_t), ("count", c_size_t), ("positions", c_void_p), ("velocities", c_void_p), ("ids", c_void_p),
                ("attributes", c_void_p * MOST_ATTRIBUTES)]


class Float(Structure):
    _fields_ = [("size", c_size_t), ("points", c_void_p), ("volumes", c_void_p), ("points_count", c_size_t), ("mass", c_float),
                ("linear_drag", c_float), ("quadratic_drag", c_float), ("state", BodyState)]


class SkinOptions(Structure):
    _fields_ = [("size", c_size_t), ("mesh", POINTER(Mesh)), ("json", c_char_p), ("map_size", c_int32)]


class SkinInputs(Structure):
    _fields_ = [("size", c_size_t), ("gravity", c_void_p), ("wind", c_void_p), ("to_world", c_void_p), ("positions", c_void_p),
                ("positions_buffer", c_uint32)]


class SkinStats(Structure):
    _fields_ = [("size", c_size_t), ("drops", c_uint64), ("added", c_double), ("on_skin", c_double), ("left", c_double), ("evaporated", c_double),
                ("refused", c_double)]


class Air(Structure):
    _fields_ = [("size", c_size_t), ("gravity", c_void_p), ("floor", c_float), ("drops", c_uint64), ("in_air", c_double), ("lost", c_double),
                ("into_water", c_double), ("from_water", c_double)]


class Shadow(Structure):
    _fields_ = [("size", c_size_t), ("texture", c_uint32), ("projection", c_void_p), ("zero_to_one", c_uint32), ("reversed", c_uint32),
                ("bias", c_float)]


class Fog(Structure):
    _fields_ = [("size", c_size_t), ("kind", c_int32), ("colour", c_float * 3), ("density", c_float), ("start", c_float), ("end", c_float),
                ("along_view", c_uint32), ("display", c_uint32)]


class Lighting(Structure):
    _fields_ = [("size", c_size_t), ("lights", c_void_p), ("lights_count", c_size_t), ("shadow", POINTER(Shadow)), ("fog", POINTER(Fog))]


class View(Structure):
    _fields_ = [("size", c_size_t), ("view", c_void_p), ("projection", c_void_p), ("near_plane", c_float), ("far_plane", c_float),
                ("light_direction", c_float * 3), ("light_colour", c_float * 3), ("units_per_metre", c_float), ("lighting", POINTER(Lighting)),
                ("renderer", c_void_p)]


class Target(Structure):
    _fields_ = [("size", c_size_t), ("framebuffer", c_uint32), ("x", c_int32), ("y", c_int32), ("width", c_int32), ("height", c_int32),
                ("colours", c_int32)]


class Surroundings(Structure):
    _fields_ = [("size", c_size_t), ("pixels", c_void_p), ("width", c_int32), ("height", c_int32), ("texture", c_uint32), ("turn", c_void_p)]


class Buffers(Structure):
    _fields_ = [("size", c_size_t), ("position", c_uint32), ("velocity", c_uint32), ("id", c_uint32), ("count", c_uint32), ("radius", c_float),
                ("wet_cells", c_uint32), ("wetness", c_uint32), ("attributes", c_uint32 * MOST_ATTRIBUTES)]


class WetSolid(Structure):
    _fields_ = [("size", c_size_t), ("from_world", c_float * 16), ("cells", c_int32 * 3), ("first_cell", c_uint32)]


class Recorded(Structure):
    _fields_ = [("size", c_size_t), ("frames", c_size_t), ("time", c_double)]
