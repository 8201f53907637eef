//! Lens and sensor effects, one file each, listed in the order of the light path.
//!
//! A new effect is one file (its parameters with their neutral values, its equation, its source) and one line in the
//! list below. Lens effects displace ideal image points and add up, (9) and (10); the others are applied by the
//! stage whose section they stand in.

/// A lens effect: how far it moves an ideal image point.
pub trait Lens {
    /// Displacement (δu, δv) in image units of the *ideal* point (u, v).
    fn displacement(&self, u: f64, v: f64) -> (f64, f64);
}

macro_rules! light_path {
    (
        scene { $( $scene:ident : $Scene:ident, )* }
        lens { $( $lens:ident : $Lens:ident, )* }
        picture { $( $picture:ident : $Picture:ident, )* }
    ) => {
        $( pub mod $scene; )* $( pub mod $lens; )* $( pub mod $picture; )*

        fmi2_export::table! {
            /// The parameters of all effects.
            pub struct Effects {
                $( #[doc = concat!("See [`", stringify!($scene), "`].")] pub $scene: $scene::$Scene, )*
                $( #[doc = concat!("See [`", stringify!($lens), "`].")] pub $lens: $lens::$Lens, )*
                $( #[doc = concat!("See [`", stringify!($picture), "`].")] pub $picture: $picture::$Picture, )*
            }
        }

        impl Effects {
            /// Distorted place of the ideal image point (u, v): all lens displacements added at the ideal point.
            #[inline]
            pub fn distorted(&self, u: f64, v: f64) -> (f64, f64) {
                let (mut du, mut dv) = (0.0, 0.0);
                $( let (a, b) = self.$lens.displacement(u, v); du += a; dv += b; )*
                (u + du, v + dv) // (9), (10)
            }

            /// FMI names and values of the lens effects' parameters.
            pub fn lens_parameters(&self) -> Vec<(&'static str, f64)> {
                let mut all = Vec::new();
                $( crate::effects::collect(&self.$lens, &mut all); )*
                all
            }

            /// These effects without one lens parameter: the value named is put to its neutral value.
            pub fn without(&self, name: &str) -> Self {
                let mut changed = self.clone();
                $( crate::effects::switch_off(&mut changed.$lens, name); )*
                changed
            }
        }
    };
}

light_path! {
    scene {
        mounting: Mounting,
    }
    lens {
        radial: Radial,
        fifth_order: FifthOrder,
        decentering: Decentering,
        thin_prism: ThinPrism,
    }
    picture {
        placement: Placement,
        sensitivity: Sensitivity,
        defocus: Defocus,
        noise: Noise,
        loss: Loss,
    }
}

fn collect<T: fmi2_export::Table>(table: &T, into: &mut Vec<(&'static str, f64)>) {
    for (index, variable) in T::variables().iter().enumerate() {
        if let Some(fmi2_export::Slot::Real(value)) = table.get(index) {
            into.push((variable.name, *value));
        }
    }
}

fn switch_off<T: fmi2_export::Table>(table: &mut T, name: &str) {
    for (index, variable) in T::variables().iter().enumerate() {
        if variable.name != name {
            continue;
        }
        if let (Some(fmi2_export::SlotMut::Real(value)), fmi2_export::Kind::Real(off)) =
            (table.get_mut(index), &variable.kind)
        {
            *value = *off;
        }
    }
}
