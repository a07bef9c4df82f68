//! Prints `topic digest` lines, then `all digest`: for every target that has a standard library.

fn main() {
    for topic in shisei_digest::TOPICS {
        println!("{} {:016x}", topic.name, topic.digest());
    }
    println!("all {:016x}", shisei_digest::digest());
}
