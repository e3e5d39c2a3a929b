//! `loadframe move-store`: the database of a lab, from its data folder to PostgreSQL or back.
use std::path::PathBuf;

use clap::Args;
use loadframe_server::store::{DatabasePlace, move_store};

use super::database::DatabaseOptions;
use super::failure::{Code, Failure};
use super::terminal::{print_json, print_line};

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Data folder of the server, which must not be running
    #[arg(long, value_name = "DIR", default_value = "loadframe-data")]
    data: PathBuf,
    #[command(flatten)]
    database: DatabaseOptions,
    /// From PostgreSQL to the data folder
    #[arg(long)]
    back: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

pub(crate) async fn perform(arguments: Arguments) -> Result<(), Failure> {
    let Arguments {
        data,
        database,
        back,
        json,
    } = arguments;
    let server = match database.place()? {
        DatabasePlace::Folder => {
            let sentence =
                "name the PostgreSQL database: --database-file FILE, or LOADFRAME_DATABASE";
            return Err(Failure::new(Code::Usage, sentence.to_owned()));
        }
        server => server,
    };
    let report = move_store(&data, &server, back).await;
    let report = report.map_err(|error| Failure::of(&error))?;
    if json {
        return print_json(&report);
    }
    let (rows, tables) = (report.rows, report.tables.len());
    print_line(&format!(
        "{rows} rows of {tables} tables were copied and compared, value by value."
    ));
    print_line(if back {
        "Start the server without --database from now on, and drop the database: it is not the lab any more."
    } else {
        "Start servers with --database-file from now on; what the folder held is loadframe.db.moved."
    });
    Ok(())
}
