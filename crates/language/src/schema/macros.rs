//! One description per block: `object!`, `choice!`.

/// A block with fixed keys.
///
/// ```text
/// object! {
///     /// What the block is.
///     pub struct Name [one of [a, b]] [checked by function] {
///         /// What the key is.
///         pub key: Type [as WANT] [= default],
///     }
/// }
/// ```
///
/// Makes the struct (with `at`, its path in the case), its reader and its schema. A key that is no name in Rust stands in
/// parentheses behind the field: `pub schema("$schema"): Option<String>`. `as` names a constant of
/// [`crate::quantity::Want`]; `one of` demands exactly one of these keys; `checked by` names a function
/// `(&Self, &mut Reader)` called on every block whose keys could be read.
macro_rules! object {
    (
        $(#[doc = $about:literal])*
        pub struct $name:ident $(one of [$($alternative:ident),*])? $(checked by $check:path)? {
            $(
                $(#[doc = $doc:literal])*
                pub $field:ident $(($key:literal))? : $type:ty $(as $want:ident)? $(= $default:expr)?
            ),* $(,)?
        }
    ) => {
        $(#[doc = $about])*
        #[derive(Clone, PartialEq, Debug)]
        pub struct $name {
            /// Path of this block in the case.
            pub at: $crate::syntax::At,
            $( $(#[doc = $doc])* pub $field: $type, )*
        }

        impl $crate::schema::read::Object for $name {
            const NAME: &'static str = stringify!($name);
            const ABOUT: &'static str = concat!($($about),*);
            const ALTERNATIVES: &'static [&'static str] = &[$($(stringify!($alternative)),*)?];

            fn names() -> Vec<&'static str> {
                vec![$( key!($field $($key)?) ),*]
            }

            fn keys(definitions: &mut $crate::schema::json::Definitions) -> Vec<$crate::schema::read::Key> {
                vec![$(
                    $crate::schema::read::Key::new::<$type>(
                        key!($field $($key)?),
                        concat!($($doc),*),
                        want!($($want)?),
                        default!($type $(, $default)?),
                        definitions,
                    )
                ),*]
            }

            fn defaults() -> Option<Self> {
                Some(Self { at: $crate::syntax::At::root(), $( $field: default!($type $(, $default)?)? ),* })
            }

            fn read_keys(
                node: &$crate::syntax::Node,
                at: &$crate::syntax::At,
                reader: &mut $crate::schema::read::Reader<'_>,
            ) -> Option<Self> {
                let before = reader.problems.len();
                $(
                    let $field: Option<$type> = reader.key(
                        node,
                        at,
                        key!($field $($key)?),
                        concat!($($doc),*),
                        want!($($want)?),
                        default!($type $(, $default)?),
                    );
                )*
                let out = Self { at: at.clone(), $( $field: $field? ),* };
                if reader.problems.len() == before {
                    $( $check(&out, reader); )?
                }
                Some(out)
            }
        }

        impl $crate::schema::read::Read for $name {
            fn absent() -> Option<Self> {
                <Self as $crate::schema::read::Object>::defaults()
            }

            fn read(
                node: &$crate::syntax::Node,
                at: &$crate::syntax::At,
                _: $crate::quantity::Want,
                reader: &mut $crate::schema::read::Reader<'_>,
            ) -> Option<Self> {
                $crate::schema::read::object(node, at, None, reader)
            }

            fn schema(
                _: $crate::quantity::Want,
                definitions: &mut $crate::schema::json::Definitions,
            ) -> serde_json::Value {
                definitions.object::<Self>(None)
            }
        }
    };
}

/// One of several words, some of which carry a value:
/// `choice! { pub enum Metric { "l2" => L2, "h1" => H1(f64) as LENGTH, } }` reads `"l2"` and `{ "h1": 0.1 }`.
macro_rules! choice {
    (
        $(#[doc = $about:literal])*
        pub enum $name:ident {
            $( $(#[doc = $doc:literal])* $text:literal => $variant:ident $( ($type:ty) $(as $want:ident)? )? ),* $(,)?
        }
    ) => {
        $(#[doc = $about])*
        #[derive(Clone, PartialEq, Debug)]
        pub enum $name {
            $( $(#[doc = $doc])* $variant $( ($type) )? ),*
        }

        impl $name {
            const CHOICES: &'static [$crate::schema::read::Choice] = &[
                $( $crate::schema::read::Choice {
                    name: $text,
                    about: concat!($($doc),*),
                    schema: choice_schema!($($type $(as $want)?)?),
                } ),*
            ];

            /// The name in the case.
            #[must_use]
            pub fn name(&self) -> &'static str {
                match self { $( choice_pattern!($variant $($type)?) => $text ),* }
            }
        }

        impl $crate::schema::read::Read for $name {
            fn read(
                node: &$crate::syntax::Node,
                at: &$crate::syntax::At,
                _: $crate::quantity::Want,
                reader: &mut $crate::schema::read::Reader<'_>,
            ) -> Option<Self> {
                let (chosen, value) = reader.choose(node, at, Self::CHOICES)?;
                match (chosen, value) {
                    $( choice_found!(inner, $text $(, $type)?) => {
                        choice_made!(inner, at, reader, $text, $variant $(, $type $(as $want)?)?)
                    } )*
                    _ => None,
                }
            }

            fn schema(
                _: $crate::quantity::Want,
                definitions: &mut $crate::schema::json::Definitions,
            ) -> serde_json::Value {
                definitions.choice(Self::CHOICES)
            }

            fn to_json(&self) -> Option<serde_json::Value> {
                let plain = Self::CHOICES.iter().any(|c| c.name == self.name() && c.schema.is_none());
                plain.then(|| self.name().into())
            }
        }
    };
}

/// The key of a field.
macro_rules! key {
    ($field:ident) => {
        $crate::schema::read::key_name(stringify!($field))
    };
    ($field:ident $key:literal) => {
        $key
    };
}

macro_rules! want {
    () => {
        $crate::quantity::Want::ANY
    };
    ($want:ident) => {
        $crate::quantity::Want::$want
    };
}

macro_rules! default {
    ($type:ty) => {
        <$type as $crate::schema::read::Read>::absent()
    };
    ($type:ty, $default:expr) => {
        Some::<$type>($default)
    };
}

macro_rules! choice_schema {
    () => { None };
    ($type:ty $(as $want:ident)?) => {
        Some(|definitions| <$type as $crate::schema::read::Read>::schema(want!($($want)?), definitions))
    };
}

macro_rules! choice_pattern {
    ($variant:ident) => {
        Self::$variant
    };
    ($variant:ident $type:ty) => {
        Self::$variant(_)
    };
}

macro_rules! choice_found {
    ($inner:ident, $text:literal) => {
        ($text, None)
    };
    ($inner:ident, $text:literal, $type:ty) => {
        ($text, Some($inner))
    };
}

macro_rules! choice_made {
    ($inner:ident, $at:ident, $reader:ident, $text:literal, $variant:ident) => { Some(Self::$variant) };
    ($inner:ident, $at:ident, $reader:ident, $text:literal, $variant:ident, $type:ty $(as $want:ident)?) => {
        <$type as $crate::schema::read::Read>::read($inner, &$at.key($text), want!($($want)?), $reader)
            .map(Self::$variant)
    };
}
