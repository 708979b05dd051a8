//! Files of convex neural networks.

use crate::quantity::{Units, Want};
use crate::schema::case::Case;
use crate::schema::network::{InputName, LayerBlock, check, network};
use crate::schema::read::{Read, Reader};
use crate::syntax::{At, Diagnostics, Document};
use nastic_energy::network::Network;

object! {
    /// A file with a network, as programs that train them write it.
    pub struct NetworkFile checked by check_file {
        /// Version of the format: 1.
        pub nastic_network: u64,
        /// As in a case.
        pub inputs: Vec<InputName>,
        /// As in a case.
        pub layers: Vec<LayerBlock>,
        /// The factor of the network, Pa; the material's own "scale" replaces it.
        pub scale: f64 as POSITIVE_PRESSURE,
    }
}

impl NetworkFile {
    /// The network, and its scale in Pa.
    #[must_use]
    pub fn network(&self) -> (Network, f64) {
        (network(&self.inputs, &self.layers), self.scale)
    }

    /// Reads a file.
    ///
    /// # Errors
    /// All problems of the file at once.
    pub fn read_document(document: &Document) -> Result<Self, Diagnostics> {
        let mut reader = Case::reader(document, Units::default());
        reader.problems.extend(document.problems().iter().cloned());
        let file = <Self as Read>::read(document.root(), &At::root(), Want::ANY, &mut reader);
        Diagnostics::new(reader.problems).into_result()?;
        file.ok_or_else(Diagnostics::default)
    }
}

fn check_file(file: &NetworkFile, reader: &mut Reader<'_>) {
    if file.nastic_network != 1 {
        let message = format!("version {} of the format is not known: it is 1", file.nastic_network);
        return reader.complain_at(&file.at.key("nastic_network"), message);
    }
    check(&file.at, &file.network().0, reader);
}
