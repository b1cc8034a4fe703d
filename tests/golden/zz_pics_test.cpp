// TEMPORARY: not committed
#include <gtest/gtest.h>
#include <fmt/format.h>
#include <cstdlib>
#include <chrono>
#include <ctime>
#include <map>
#include <sstream>
#include "engine/app/capture.h"
#include "engine/scene/head_look.h"
#include "engine/scene/import_model.h"
#include "engine/scene/skin.h"
#include "engine/scene/transform.h"
#include "tests/golden/look_fixture.h"
#include "fluid/sim/cpu_kernels.h"
namespace rivulet {
namespace {
const std::string kHead = std::string(RIVULET_SOURCE_DIR) + "/assets/meshes/head/";
std::string env(const char* n, const char* d) { const char* v = std::getenv(n); return v ? v : d; }
// a map of caps and trails painted in UV by the skin's own metric
struct Painter {
    const Mesh& mesh; int size; std::vector<vec4> texels; std::vector<float> h, w; std::vector<vec3> posOf; std::vector<uint8_t> owned;
    std::vector<vec3> tu, tv;
    Painter(const Mesh& m, int s) : mesh(m), size(s), texels(size_t(s)*s, vec4(0)), h(size_t(s)*s,0), w(size_t(s)*s,0), posOf(size_t(s)*s), owned(size_t(s)*s,0), tu(size_t(s)*s), tv(size_t(s)*s) {
        for (size_t t=0;t+2<m.indices.size();t+=3){
            uint32_t a=m.indices[t],b=m.indices[t+1],c=m.indices[t+2];
            vec2 ua=m.uvs[a]*float(s),ub=m.uvs[b]*float(s),uc=m.uvs[c]*float(s);
            vec2 e1=ub-ua,e2=uc-ua; float det=e1.x*e2.y-e1.y*e2.x; if(std::abs(det)<1e-9f) continue;
            vec3 p1=m.positions[b]-m.positions[a],p2=m.positions[c]-m.positions[a];
            vec3 T=(p1*e2.y-p2*e1.y)/det*float(s), B=(p2*e1.x-p1*e2.x)/det*float(s);
            vec2 lo=glm::min(ua,glm::min(ub,uc))-1.0f,hi=glm::max(ua,glm::max(ub,uc))+1.0f;
            for(int y=std::max(0,int(lo.y));y<=std::min(s-1,int(hi.y));++y)for(int x=std::max(0,int(lo.x));x<=std::min(s-1,int(hi.x));++x){
                vec2 q=vec2(x+0.5f,y+0.5f)-ua; float l1=(q.x*e2.y-q.y*e2.x)/det,l2=(e1.x*q.y-e1.y*q.x)/det;
                if(l1<-0.2f||l2<-0.2f||l1+l2>1.2f) continue;
                size_t i=size_t(y)*s+x; bool in=l1>=-1e-3f&&l2>=-1e-3f&&l1+l2<=1.001f; if(owned[i]==2&&!in) continue; if(owned[i]&&!in) continue;
                owned[i]=in?2:1; posOf[i]=m.positions[a]+p1*l1+p2*l2; tu[i]=T; tv[i]=B;
            }
        }
    }
    vec3 at(vec2 uv) const { int x=int(uv.x*size),y=int(uv.y*size); return posOf[size_t(y)*size+x]; }
    void cap(vec3 c, float R, float V, float stretchY=1.0f){ float H=2*V/(kPi*R*R);
        for(size_t i=0;i<h.size();++i) if(owned[i]){ vec3 d=posOf[i]-c; if(d.y>0) d.y/=stretchY; float r2=glm::dot(d,d)/(R*R); if(r2<1.1f){ float k=std::max(0.0f,1-r2); h[i]=std::max(h[i],H*k); w[i]=std::max(w[i],std::clamp((1.1f-r2)*8,0.f,1.f)); } } }
    void trail(const std::vector<vec3>& path,float width,float thick){
        for(size_t i=0;i<h.size();++i) if(owned[i]){ float best=1e9f; for(size_t k=0;k+1<path.size();++k){ vec3 a=path[k],b=path[k+1],ab=b-a; float t=std::clamp(glm::dot(posOf[i]-a,ab)/glm::dot(ab,ab),0.f,1.f); best=std::min(best,glm::distance(posOf[i],a+ab*t)); }
            float r=best/(0.5f*width); if(r<1.2f){ float k=std::clamp((1.2f-r)/0.5f,0.f,1.f); k=k*k*(3-2*k); h[i]=std::max(h[i],thick*k); w[i]=std::max(w[i],k);} } }
    gpu::Texture texture(){
        for(int y=1;y+1<size;++y)for(int x=1;x+1<size;++x){ size_t i=size_t(y)*size+x; texels[i]=vec4((h[i+1]-h[i-1])*0.5f*size,(h[i+size]-h[i-size])*0.5f*size,h[i]*1000,w[i]); }
        auto t=gpu::Texture::create({.width=size,.height=size,.format=gpu::Format::rgba16f,.mips=0}); t->upload(std::as_bytes(std::span(texels))); t->generateMips(); return std::move(*t);
    }
};
class Pics : public LookTest {};
TEST_F(Pics, head) {
    auto made = importModel(kHead + "head.glb"); ASSERT_TRUE(made) << made.error().message;
    Model model = std::move(*made); auto dressed = dressHead(model, kHead); ASSERT_TRUE(dressed) << dressed.error().message;
    auto device = makeCpuDevice(cpuKernels(), {});
    std::vector<std::shared_ptr<Deformer>> deformers;
    const auto world = model.worldMatrices();
    auto layer = std::make_shared<Layer>(); gpu::Texture map;
    { const Mesh& skin=model.find("skin")->mesh; Painter p(skin,std::stoi(env("MAP","1024")));
      auto snap=[&](vec3 q){ float b=1e9f; vec3 r; for(size_t i=0;i<p.posOf.size();++i) if(p.owned[i]==2){ vec3 d=p.posOf[i]-q; float e=d.x*d.x+d.y*d.y+ (p.posOf[i].z<0.0f?1.f:0.f); if(e<b){b=e;r=p.posOf[i];} } return r; };
      for(float side : {-1.0f,1.0f}) { std::vector<vec3> path; for(vec2 q : {vec2(0.0200f,0.0225f),vec2(0.0205f,0.016f),vec2(0.0225f,0.008f),vec2(0.0245f,0.0f),vec2(0.0262f,-0.010f),vec2(0.0275f,-0.020f),vec2(0.028f,-0.030f)}) path.push_back(snap(vec3(side*q.x,q.y,0)));
        if (side>0) path.resize(4);
        p.trail(path,0.002f,2e-5f);
        p.cap(path.back(),0.0019f,3.5e-9f,1.7f);
        p.cap(path[0],0.0014f,1.2e-9f); p.cap(path[2],0.0011f,0.5e-9f,1.2f); }
      p.cap(snap(vec3(-0.036f,0.004f,0)),0.0015f,2.0e-9f); p.cap(snap(vec3(-0.041f,-0.004f,0)),0.001f,0.6e-9f); p.cap(snap(vec3(-0.034f,-0.006f,0)),0.002f,5e-9f,1.2f);
      map=p.texture(); layer->texels=&map; }
    std::vector<float> weights(11,0.0f); { std::istringstream in(env("MORPH","")); int k; float v; while(in>>k>>v) weights[size_t(k)]=v; }
    for (ModelPart& part : model.parts) {
        Node node; node.name=part.name; node.local=world[size_t(part.node)]; node.material=part.material;
        node.mesh=std::make_shared<const Mesh>(part.mesh);
        if(!part.morphs.empty()){ auto d=Deformer::create(*device,part); ASSERT_TRUE(d)<<d.error().message; auto s=std::make_shared<Deformer>(std::move(*d)); s->run(weights); deformers.push_back(s); node.deformer=s; }
        if(part.name=="skin" && env("WET","1")=="1") node.layer=layer;
        scene.add(std::move(node));
    }
    settings.background.showFloor=false; settings.background.showBox=false; settings.fluid.box={.min=vec3(-0.05f),.max=vec3(0.05f)};
    { std::istringstream in(env("BG","0.30 0.31 0.33 0.16 0.17 0.19")); in>>settings.background.horizon.x>>settings.background.horizon.y>>settings.background.horizon.z>>settings.background.zenith.x>>settings.background.zenith.y>>settings.background.zenith.z; }
    { std::istringstream in(env("LIGHT","-0.55 0.55 0.75 3.0")); in>>settings.light.direction.x>>settings.light.direction.y>>settings.light.direction.z>>settings.light.intensity; }
    std::string views=env("VIEWS","front threeq eye cheek"); std::istringstream in(views); std::string v;
    int W=std::stoi(env("W","1920")),H=std::stoi(env("H","1080"));
    while(in>>v){ Camera c; 
        if(v=="front"){c.position=vec3(0,0.0f,0.85f);c.target=vec3(0,-0.005f,0);c.fieldOfView=20;}
        if(v=="threeq"){c.position=vec3(-0.48f,0.03f,0.66f);c.target=vec3(0.0f,-0.005f,0);c.fieldOfView=20;}
        if(v=="eye"){c.position=vec3(-0.06f,0.03f,0.20f);c.target=vec3(-0.028f,0.02f,0.035f);c.fieldOfView=16;}
        if(v=="cheek"){c.position=vec3(-0.11f,-0.01f,0.20f);c.target=vec3(-0.030f,0.002f,0.036f);c.fieldOfView=15;}
        if(v=="side"){c.position=vec3(-0.8f,0.0f,0.1f);c.target=vec3(0.0f,-0.005f,-0.02f);c.fieldOfView=20;}
        if(v=="macro"){c.position=vec3(-0.08f,-0.01f,0.12f);c.target=vec3(-0.034f,-0.004f,0.036f);c.fieldOfView=13;}
        c.setPlanes(Bounds{vec3(-0.1f,-0.15f,-0.12f),vec3(0.1f,0.15f,0.1f)}); c.nearPlane=0.02f;
        auto rgba=picture(c,W,H,{}); 
        int n=std::stoi(env("TIME","0")); if(n){ double best=1e9; std::map<std::string,double> pass; for(int k=0;k<n;++k){ auto t0=std::chrono::steady_clock::now(); deformers[0]->run(std::vector<float>{0.01f*k}); picture(c,W,H,{}); best=std::min(best,std::chrono::duration<double,std::milli>(std::chrono::steady_clock::now()-t0).count()); for(auto& p:renderer().times()){ double ms=p.ms/std::max(p.calls,1); auto it=pass.emplace(p.name,ms).first; it->second=std::min(it->second,ms);} } fmt::print("{} {:.1f} ms:",v,best); for(auto& [k,m]:pass) fmt::print(" {} {:.1f}",k,m); fmt::print("\n"); }
        auto ok_=writePng(env("OUT","/tmp/look_pics/")+v+".png",rgba,W,H); ASSERT_TRUE(ok_)<<ok_.error().message; }
    scene=Scene(); deformers.clear();
}
}  // namespace
}  // namespace rivulet
