// scenes/prism for POV-Ray 3.7, to time it: the same prism, slits, spheres and floor. `Bands` is
// declared on the command line. The dispersion number is n(400 nm) / n(700 nm) of each glass.
#version 3.7;
#ifndef (Bands) #declare Bands = 16; #end
global_settings { max_trace_level 16 assumed_gamma 1 }
camera {
  location <0, 0.152657, -0.7>
  direction <0, 0, 1> up <0, 1, 0> right <16/9, 0, 0>
  angle 30.1
  rotate <0, 0, 0>
  look_at <0, 0.06, 0>
}
light_source { <-0.582, 0.7275, -0.5335> color rgb 1 spotlight point_at <0, 0.05, 0> radius 8 falloff 26 }
light_source { <0, -0.25, 1.05> color rgb 0.3 spotlight point_at <0, 0.6, 1.5> radius 5 falloff 80 }
#macro Slit(W, Y0, Y1, X, L)
  box { <X - W, Y0, -0.0011>, <X + W, Y1, -0.001>
    texture { pigment { color rgb L } finish { emission 1 ambient 0 diffuse 0 } } }
#end
#macro Screen()
  box { <-0.17, -0.22, 0>, <0.17, 0.24, 0.0005>
    texture { pigment { color rgb 0.045 } finish { emission 1 ambient 0 diffuse 0 } } }
#end
union {
  Screen()
  Slit(0.011, -0.1, 0.118, -0.018, 7)
  rotate y*66 translate <0.411095456, 0, 0.183031489>
}
union {
  Screen()
  Slit(0.011, 0.086, 0.118, 0.027, 9)
  Slit(0.012, 0.05, 0.082, 0.024, 6)
  Slit(0.015, 0.014, 0.046, 0.02, 3.6)
  Slit(0.024, -0.022, 0.01, 0.017, 2.2)
  Slit(0.04, -0.058, -0.026, 0.013, 1.4)
  rotate -y*66 translate <-0.411095456, 0, 0.183031489>
}
intersection {
  plane { <0.866025404, 0, -0.5>, 0.0323316151 }
  plane { <-0.866025404, 0, -0.5>, 0.0323316151 }
  plane { <0, 0, 1>, 0.0323316151 }
  plane { <0, 0, -1>, 0.0637632301 }
  plane { <0.866025404, 0, 0.5>, 0.0637632301 }
  plane { <-0.866025404, 0, 0.5>, 0.0637632301 }
  plane { <0.612372436, 0.707106781, -0.353553391>, 0.114155786 }
  plane { <-0.612372436, 0.707106781, -0.353553391>, 0.114155786 }
  plane { <0, 0.707106781, 0.707106781>, 0.114155786 }
  plane { <0, 1, 0>, 0.13 }
  plane { <0, -1, 0>, 0 }
  bounded_by { box { <-0.057, 0, -0.066>, <0.057, 0.131, 0.033> } }
  translate <0, 0.0183, 0>
  texture { pigment { color rgbf 1 } finish { ambient 0 diffuse 0 reflection { 0, 1 fresnel } conserve_energy } }
  interior { ior 1.78472 dispersion 1.0420 dispersion_samples Bands }
}
sphere { <-0.112, 0.033, -0.035>, 0.033
  texture { pigment { color rgb 0 } finish { ambient 0 diffuse 0 reflection 0.95 } } }
sphere { <0.098, 0.025, -0.062>, 0.025
  texture { pigment { color rgbf 1 } finish { ambient 0 diffuse 0 reflection { 0, 1 fresnel } conserve_energy } }
  interior { ior 1.5168 dispersion 1.0117 dispersion_samples Bands } }
cylinder { <0, -0.016, 0>, <0, 0, 0>, 0.18
  texture { pigment { checker color rgb 0.6 color rgb 0.05 scale 0.025 }
            finish { ambient 0.03 diffuse 0.9 reflection { 0, 1 fresnel } conserve_energy } }
  interior { ior 1.5 } }
box { <-0.07, 0, -0.07>, <0.07, 0.018, 0.07>
  texture { pigment { color rgb 0.03 } finish { ambient 0.03 diffuse 0.9 reflection { 0, 1 fresnel } conserve_energy } }
  interior { ior 1.5 } }
box { <-1.5, -0.7, -1.5>, <1.5, 1.3, 1.5> hollow
  texture { pigment { color rgb 0.16 } finish { ambient 0.03 diffuse 0.9 } } }
