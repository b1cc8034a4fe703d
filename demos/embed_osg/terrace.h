// The host's own scene: a pool of 1.2 m in a terrace, its front of glass, a mosaic and a pole in it, and a post before it.
#pragma once

#include <osg/Geometry>
#include <osg/Image>
#include <osg/Material>
#include <osg/ShapeDrawable>
#include <osg/Texture2D>

// u x v tiles in two colours over a parallelogram.
inline osg::ref_ptr<osg::Geometry> tiles(osg::Vec3 at, osg::Vec3 u, int nu, osg::Vec3 v, int nv, osg::Vec4 one, osg::Vec4 other) {
    osg::ref_ptr<osg::Image> image = new osg::Image;
    image->allocateImage(64, 64, 1, GL_RGBA, GL_FLOAT);
    for (int k = 0; k < 64 * 64; ++k) image->setColor((k / 32 + k / 2048) % 2 != 0 ? one : other, k % 64, k / 64);
    osg::ref_ptr<osg::Texture2D> texture = new osg::Texture2D(image);
    texture->setWrap(osg::Texture::WRAP_S, osg::Texture::REPEAT);
    texture->setWrap(osg::Texture::WRAP_T, osg::Texture::REPEAT);
    texture->setMaxAnisotropy(16);
    osg::ref_ptr<osg::Geometry> geometry = osg::createTexturedQuadGeometry(at, u, v, 0.5F * float(nu), 0.5F * float(nv));
    geometry->getOrCreateStateSet()->setTextureAttributeAndModes(0, texture);
    return geometry;
}

// A round post of `height` on (x, 0, z).
inline osg::ref_ptr<osg::ShapeDrawable> post(float x, float z, float radius, float height, osg::Vec4 colour) {
    osg::ref_ptr<osg::Cylinder> round = new osg::Cylinder({x, 0.5F * height, z}, radius, height);
    round->setRotation({-osg::PI_2, osg::X_AXIS});
    osg::ref_ptr<osg::ShapeDrawable> drawn = new osg::ShapeDrawable(round);
    drawn->setColor(colour);
    return drawn;
}

inline osg::ref_ptr<osg::Group> terrace() {
    const osg::Vec3 x(1.2F, 0, 0), y(0, 0.42F, 0), z(0, 0, 1.2F), far(9, 0, 0);
    const osg::Vec4 a(0.72F, 0.86F, 0.86F, 1), b(0.84F, 0.93F, 0.92F, 1), c(0.86F, 0.80F, 0.71F, 1), d(0.80F, 0.74F, 0.65F, 1);
    osg::ref_ptr<osg::Group> all = new osg::Group;
    for (const auto& part :
         {tiles(z, x, 16, -z, 16, a, b), tiles({0.3F, 0.002F, 0.9F}, x * 0.5F, 8, -z * 0.5F, 8, {0.16F, 0.33F, 0.62F, 1}, b),
          tiles({}, x, 16, y, 6, a, b), tiles(z, -z, 16, y, 6, a, b), tiles(x, z, 16, y, 6, a, b),
          tiles(y - far, x + far * 2, 96, z * -7.5F, 45, c, d), tiles(y + z - far, far, 45, -z, 6, c, d),
          tiles(x + y + z, far, 45, -z, 6, c, d), tiles(z * 2.5F - far, x + far * 2, 96, z * -1.5F, 9, c, d),
          tiles(z - x * 2, x * 2, 12, y, 2, c, d), tiles(x + z, x * 2, 12, y, 2, c, d)})
        all->addChild(part);
    all->addChild(post(0.14F, 1.42F, 0.05F, 0.27F, {0.78F, 0.24F, 0.16F, 1}));
    all->addChild(post(0.72F, 0.40F, 0.016F, 0.80F, {0.93F, 0.70F, 0.22F, 1}));
    osg::ref_ptr<osg::Material> paint = new osg::Material;
    paint->setColorMode(osg::Material::AMBIENT_AND_DIFFUSE);
    all->getOrCreateStateSet()->setAttributeAndModes(paint);
    return all;
}
