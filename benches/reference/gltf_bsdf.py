"""glTF 2.0's material as a BSDF of Mitsuba 3, from the specification's text (appendix B, and those of the extensions), without bspray's code.

Mitsuba's own `principled` is Disney's: its matt ground reflects back towards the light, its dielectric is exact Fresnel's, it has no thin walls with
rough passages; pictures of it are no picture of a glTF file. `Model.SPECIFICATION` is the specification literally:

    material = mix(fresnel_mix(0.04, mix(diffuse, btdf, transmission), specular), metal(specular), metallic), coated
    specular = GGX, alpha = roughness^2, separable Smith masking; fresnel_mix weighs by Schlick's F(V.H)

`Model.CONSERVING` replaces the two things by which these formulas lose or make light: mirrors get back what bounces among their microfacets (Turquin
2019, with height-correlated masking), and the ground gets what the dielectric's directional albedo leaves. Its tables are summed here.

All directions are world space, unit, away from the surface. Both sides of a surface are alike.
"""
from enum import Enum

import drjit as dr
import mitsuba as mi
import numpy as np

# Narrower lobes are no sharper to a pixel, and single precision loses their peaks.
LEAST_ALPHA = 1.5e-3

MATERIALS = []


class Model(Enum):
    SPECIFICATION = "specification"
    CONSERVING = "conserving"


MODEL = Model.SPECIFICATION
# Whether light fades out that grazes the surface but not its shading normal (Chiang, Li and Burley 2019), as bspray has it for all lobes.
HAS_TERMINATOR = False
TABLE = []


def use(model):
    global MODEL
    MODEL = model
    if model is Model.CONSERVING and not TABLE:
        TABLE.append(mi.Texture2f(mi.TensorXf(albedo_table()), filter_mode=dr.FilterMode.Linear, wrap_mode=dr.WrapMode.Clamp))


def albedo_table(side=64, n=4096):
    """By cosine (columns) and roughness (rows), both from 0 to 1: what white mirrors reflect in all, and the share of it that Schlick's (1 - V.H)^5 weighs."""
    i = np.arange(n) + 0.5
    u, v = i / n, (i * 0.6180339887498949) % 1
    table = np.zeros((side, side, 2), np.float32)
    for row in range(side):
        alpha = max((row / (side - 1)) ** 2, LEAST_ALPHA)
        for column in range(side):
            z = max(column / (side - 1), 1e-3)
            o = np.array([np.sqrt(1 - z * z), 0, z])
            s = o * [alpha, alpha, 1]
            s /= np.linalg.norm(s)
            h = (1 - v) * (1 + s[2]) - s[2]
            r = np.sqrt(np.maximum(1 - h * h, 0))
            h = np.stack([r * np.cos(2 * np.pi * u), r * np.sin(2 * np.pi * u), h], 1) + s
            h *= [alpha, alpha, 1]
            h /= np.linalg.norm(h, axis=1, keepdims=True)
            oh = h @ o
            lz = (2 * oh[:, None] * h - o)[:, 2]
            lam = lambda c: 0.5 * (np.sqrt(1 + alpha**2 * (1 - c * c) / (c * c)) - 1)
            lit = lz > 1e-6
            weight = np.where(lit, (1 + lam(z)) / (1 + lam(z) + lam(np.where(lit, lz, 1.0))), 0)
            table[row, column] = weight.mean(), (weight * (1 - oh) ** 5).mean()
    return table


def fifth(x):
    x = dr.clip(1 - x, 0, 1)
    return dr.square(dr.square(x)) * x


class Lobe:
    """GGX around a normal, of white mirrors."""

    def __init__(self, n, v, alpha):
        self.frame, self.alpha = mi.Frame3f(n), alpha
        self.o = self.frame.to_local(v)
        self.o.z = dr.maximum(self.o.z, 1e-4)

    def root(self, c):
        a2 = dr.square(self.alpha)
        return dr.sqrt(a2 + (1 - a2) * dr.square(c))

    def evaluate(self, i):
        """Value times the light's cosine, density, and V.H, for a local direction above the surface."""
        h = dr.normalize(self.o + i)
        a2 = dr.square(self.alpha)
        d = a2 / (dr.pi * dr.square(a2 * dr.square(h.z) + dr.square(h.x) + dr.square(h.y)))
        o, l = self.o.z, dr.maximum(i.z, 1e-6)
        if MODEL is Model.CONSERVING:
            v = 0.5 / (l * self.root(o) + o * self.root(l))
        else:
            v = 1 / ((l + self.root(l)) * (o + self.root(o)))
        # Density of visible normals over 4 V.H.
        density = d / (2 * (o + self.root(o)))
        return d * v * l, density, dr.dot(self.o, h)

    def sample(self, u):
        s = dr.normalize(mi.Vector3f(self.o.x * self.alpha, self.o.y * self.alpha, self.o.z))
        z = dr.fma(1 - u.y, 1 + s.z, -s.z)
        r = dr.safe_sqrt(1 - z * z)
        sine, cosine = dr.sincos(dr.two_pi * u.x)
        h = mi.Vector3f(r * cosine, r * sine, z) + s
        h = dr.normalize(mi.Vector3f(h.x * self.alpha, h.y * self.alpha, dr.maximum(h.z, 1e-7)))
        return 2 * dr.dot(self.o, h) * h - self.o


class Gltf(mi.BSDF):
    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        m = self.m = MATERIALS[int(props["material"])]
        F = mi.BSDFFlags
        self.has_alpha = m.alpha_mode != "OPAQUE"
        components = [F.GlossyReflection | F.FrontSide | F.BackSide, F.DiffuseReflection | F.FrontSide | F.BackSide]
        if m.transmission > 0:
            components.append(F.GlossyTransmission | F.FrontSide | F.BackSide)
        if self.has_alpha:
            components.append(F.Null | F.FrontSide | F.BackSide)
        self.m_components = components
        self.m_flags = 0
        for c in components:
            self.m_flags |= c
        self.base = mi.Color3f(m.base_color[:3])
        self.factors = mi.Color3f(m.metallic, m.roughness, m.transmission)
        dr.make_opaque(self.base, self.factors)
        self.colors = m.vertex_color and mi.load_dict({"type": "mesh_attribute", "name": "vertex_color"})
        attribute = lambda name: mi.load_dict({"type": "mesh_attribute", "name": name})
        self.tangent = attribute("vertex_tangent") if "normal" in m.slots else None
        self.side = attribute("vertex_side") if "normal" in m.slots else None
        self.second = attribute("vertex_second") if any(s.uv_set == 1 for s in m.slots.values()) else None

    def texel(self, name, si, active):
        slot = self.m.slots.get(name)
        if slot is None:
            return [1.0, 1.0, 1.0, 1.0]
        uv = si.uv
        if slot.uv_set == 1:
            second = self.second.eval(si, active)
            uv = mi.Point2f(second[0], second[1])
        a = slot.matrix
        if not np.array_equal(a, np.eye(3)[:2]):
            uv = mi.Point2f(*(float(a[i, 0]) * uv.x + float(a[i, 1]) * uv.y + float(a[i, 2]) for i in range(2)))
        return slot.texture.eval(uv, active)

    def coverage(self, si, active):
        a = self.texel("base_color", si, active)[3] * self.m.base_color[3]
        if self.m.alpha_mode == "MASK":
            return dr.select(a >= self.m.cutoff, mi.Float(1), mi.Float(0))
        return dr.clip(a, 0, 1)

    def prepare(self, si, active):
        """The material's values here, and the lobes for the viewer."""
        m, p = self.m, lambda: None
        color = self.texel("base_color", si, active)
        p.base = self.base * mi.Color3f(color[0], color[1], color[2])
        if self.colors:
            p.base *= self.colors.eval(si, active)
        mr = self.texel("metallic_roughness", si, active)
        p.metallic = self.factors.x * mr[2]
        rough = self.factors.y * mr[1]
        alpha = dr.maximum(dr.square(rough), LEAST_ALPHA)
        p.transmission = self.factors.z * self.texel("transmission", si, active)[0]
        v = si.to_world(si.wi)
        is_back = dr.dot(v, si.n) < 0
        turn = lambda n: dr.select(is_back, -n, n)
        p.geometric = turn(si.n)
        smooth = turn(si.sh_frame.n)
        smooth = dr.select(dr.dot(smooth, v) > 0, smooth, p.geometric)
        p.normal = smooth
        if self.tangent is not None:
            t = mi.Vector3f(self.tangent.eval(si, active))
            front = turn(smooth)
            t = dr.normalize(t)
            b = dr.cross(front, t) * self.side.eval_1(si, active)
            x = self.texel("normal", si, active)
            n = t * ((2 * x[0] - 1) * m.normal_scale) + b * ((2 * x[1] - 1) * m.normal_scale) + front * (2 * x[2] - 1)
            n = turn(dr.normalize(n))
            p.normal = dr.select((dr.dot(n, v) > 0) & dr.isfinite(n.x), n, smooth)
        p.lobe = Lobe(p.normal, v, alpha)
        p.f0 = ((m.ior - 1) / (m.ior + 1)) ** 2 * m.f0_factor
        p.f90 = 1.0 if m.f0_factor > 0 else 0.0
        if MODEL is Model.CONSERVING:
            side = TABLE[0].shape[0]
            p.e = TABLE[0].eval((mi.Point2f(p.lobe.o.z, dr.sqrt(alpha)) * (side - 1) + 0.5) / side)
        p.coat = None
        p.above = 1.0
        if m.coat > 0:
            p.coat = Lobe(smooth, v, mi.Float(max(m.coat_roughness**2, LEAST_ALPHA)))
            p.above = 1 - m.coat * (0.04 + 0.96 * fifth(p.coat.o.z))
        # Chances of the lobes: mirrors, ground, passage, coat.
        weight = fifth(p.lobe.o.z)
        mirror = dr.lerp(p.f0 + (p.f90 - p.f0) * weight, dr.mean(p.base) + (1 - dr.mean(p.base)) * weight, p.metallic) + 0.02
        ground = (1 - p.metallic) * dr.max(p.base) * (1 - p.f0)
        p.chances = [mirror, ground * (1 - p.transmission), ground * p.transmission if m.transmission > 0 else mi.Float(0), mi.Float(0)]
        if p.coat is not None:
            p.chances[3] = 1.2 * (1 - p.above) * (mirror + ground)
        total = p.chances[0] + p.chances[1] + p.chances[2] + p.chances[3]
        p.chances = [c / total for c in p.chances]
        return p

    def value(self, p, to_light, active):
        """BSDF times cosine, and density, without coverage."""
        i = p.lobe.frame.to_local(to_light)
        side = dr.dot(to_light, p.geometric)
        reflects = active & (i.z > 0) & (side > 0)
        passes = active & (i.z < 0) & (side < 0)
        above = mi.Vector3f(i.x, i.y, dr.abs(i.z))
        white, density, vh = p.lobe.evaluate(above)
        weight = fifth(vh)
        dielectric = p.f0 + (p.f90 - p.f0) * weight
        metal = p.base + (1 - p.base) * weight
        below, gain, metal_gain, thin_gain = 1 - dielectric, 1.0, 1.0, 1.0
        if MODEL is Model.CONSERVING:
            whole, edge = p.e
            lost = 1 / whole - 1
            gain, metal_gain, thin_gain = 1 + p.f0 * lost, 1 + p.base * lost, 1 / whole
            below = 1 - (p.f0 * (whole - edge) + p.f90 * edge) * gain
        ground = p.base * below * (above.z * dr.inv_pi * (1 - p.transmission))
        value = dr.lerp(mi.Color3f(dielectric * gain * white) + ground, metal * metal_gain * white, mi.Color3f(p.metallic)) * p.above
        pdf = p.chances[0] * density + p.chances[1] * above.z * dr.inv_pi
        if p.coat is not None:
            local = p.coat.frame.to_local(to_light)
            of_coat, coat_density, _ = p.coat.evaluate(mi.Vector3f(local.x, local.y, dr.maximum(local.z, 1e-6)))
            is_above = local.z > 0
            value += dr.select(is_above, (1 - p.above) * of_coat, 0)
            pdf += dr.select(is_above, p.chances[3] * coat_density, 0)
        through = p.base * below * white * thin_gain * (p.transmission * (1 - p.metallic)) * p.above
        if HAS_TERMINATOR:
            share = dr.clip(side / (above.z * dr.dot(p.geometric, p.normal)), 0, 1)
            value *= share + dr.square(share) - share * dr.square(share)
        value = dr.select(reflects, value, dr.select(passes, through, 0))
        pdf = dr.select(reflects, pdf, dr.select(passes, p.chances[2] * density, 0))
        return value, pdf

    def choose(self, p, u1, u2, active):
        c = p.chances
        mirrored = p.lobe.sample(u2)
        matt = mi.warp.square_to_cosine_hemisphere(u2)
        is_matt = (u1 >= c[0]) & (u1 < c[0] + c[1])
        is_thin = (u1 >= c[0] + c[1]) & (u1 < c[0] + c[1] + c[2])
        local = dr.select(is_matt, matt, mirrored)
        local.z = dr.select(is_thin, -local.z, local.z)
        out = p.lobe.frame.to_world(local)
        if p.coat is not None:
            out = dr.select(u1 >= c[0] + c[1] + c[2], p.coat.frame.to_world(p.coat.sample(u2)), out)
        out = dr.normalize(out)
        # A facet may mirror into the surface, or out of it on the way through: that light is lost.
        up = dr.dot(out, p.normal) > 0
        active = active & dr.select(is_thin, ~up, up)
        value, pdf = self.value(p, out, active)
        active &= (pdf > 0) & dr.isfinite(pdf)
        return out, dr.select(active, value / dr.select(pdf > 0, pdf, 1), 0), dr.select(active, pdf, 0), is_matt, is_thin

    def of_sample(self, p, si, u1, u2, active):
        bs = dr.zeros(mi.BSDFSample3f)
        a = self.coverage(si, active) if self.has_alpha else None
        if a is not None:
            is_null = u1 >= a
            u1 = dr.minimum(u1 / dr.maximum(a, 1e-6), 0.99999994)
        out, weight, pdf, is_matt, is_thin = self.choose(p, u1, u2, active)
        F = mi.BSDFFlags
        kind = dr.select(is_matt, mi.UInt32(F.DiffuseReflection.value), dr.select(is_thin, mi.UInt32(F.GlossyTransmission.value), mi.UInt32(F.GlossyReflection.value)))
        bs.wo, bs.pdf, bs.eta, bs.sampled_type, bs.sampled_component = si.to_local(out), pdf, 1.0, kind, 0
        if a is not None:
            bs.wo = dr.select(is_null, -si.wi, bs.wo)
            bs.pdf = dr.select(is_null, 1 - a, bs.pdf * a)
            bs.sampled_type = dr.select(is_null, mi.UInt32(F.Null.value), kind)
            weight = dr.select(is_null, 1, weight)
        return bs, weight & active

    def of_value(self, p, si, wo, active):
        value, pdf = self.value(p, si.to_world(wo), active)
        if self.has_alpha:
            a = self.coverage(si, active)
            value, pdf = value * a, pdf * a
        return value, pdf

    def sample(self, ctx, si, u1, u2, active=True):
        return self.of_sample(self.prepare(si, active), si, u1, u2, active)

    def eval(self, ctx, si, wo, active=True):
        return self.of_value(self.prepare(si, active), si, wo, active)[0]

    def pdf(self, ctx, si, wo, active=True):
        return self.of_value(self.prepare(si, active), si, wo, active)[1]

    def eval_pdf(self, ctx, si, wo, active=True):
        return self.of_value(self.prepare(si, active), si, wo, active)

    def eval_pdf_sample(self, ctx, si, wo, u1, u2, active=True):
        p = self.prepare(si, active)
        return *self.of_value(p, si, wo, active), *self.of_sample(p, si, u1, u2, active)

    def to_string(self):
        return f"Gltf[{self.m.name}]"
