//! Requests of the page, and the functions that answer them.

use super::access::Access;
use super::connections::Place;
use super::http::{Connection, Head, Response, Unread};
use super::job::Job;
use super::message::{
    CurvesRequest, Designed, EditRequest, InfluenceRequest, JobRequest, SaveRequest, Saved,
    SolveRequest, SolvedAnswer, StartRequest, TuneRequest,
};
use super::reading::{Files, Reading};
use super::study_file::{NotSaved, Over, name_of};
use super::turns::{STOPPED, Stop, Turns};
use super::{page, start};
use crate::threads::stoppable;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

/// Number of study texts that the server stores. With these texts, tabs opened before a save keep working, and the user can undo
/// changes of values. A request that refers to an older text gets status 410. The page then sends the edits of this text again.
const TEXTS: usize = 40;
/// Media types of exported files.
const CSV: &str = "text/csv; charset=utf-8";
const DXF: &str = "image/vnd.dxf";
/// Number of report pages that the server stores.
const REPORTS: usize = 3;

/// State of the server.
pub(super) struct ServerState {
    pub access: Access,
    /// True after the first request with the token.
    pub visited: AtomicBool,
    /// Folder into which the server writes a new study.
    directory: PathBuf,
    /// File of the study. Without a study, the page asks for one.
    file: OnceLock<Files>,
    /// Study texts that the server has read or edited, the most recently used text last.
    texts: Mutex<VecDeque<Arc<dyn Reading>>>,
    /// Latest tuning, running or ended.
    job: Mutex<Option<Arc<Job>>>,
    /// Report pages with their numbers, the latest page last.
    reports: Mutex<VecDeque<(u64, Arc<str>)>>,
    /// Lock that allows only one save at a time.
    saving: Mutex<()>,
    turns: Turns,
}

/// Refusal of a request: HTTP status and reason in words.
type Refused = (u16, String);

impl ServerState {
    /// State of a server without a study. The user can choose a study on the page, which the server writes to `directory`.
    pub(super) fn new(access: Access, directory: PathBuf) -> Self {
        ServerState {
            access,
            visited: AtomicBool::new(false),
            directory,
            file: OnceLock::new(),
            texts: Mutex::default(),
            job: Mutex::new(None),
            reports: Mutex::default(),
            saving: Mutex::new(()),
            turns: Turns::default(),
        }
    }

    /// Starts to serve a study that was read. A server has only one study, so it refuses a second one.
    pub(super) fn take(&self, file: Files, opened: Arc<dyn Reading>) -> Result<(), String> {
        let taken = self.file.set(file);
        taken.map_err(|_| "another tab has chosen a study: reload the page".to_owned())?;
        self.remember(opened);
        Ok(())
    }

    fn file(&self) -> Result<&Files, Refused> {
        let none = || (409, "no study is chosen yet: reload the page".to_owned());
        self.file.get().ok_or_else(none)
    }

    /// Serves a connection until it ends.
    pub(super) fn serve(&self, connection: &mut Connection, place: &mut Place) {
        loop {
            let (response, keeps) = match connection.head() {
                Err(Unread::Gone) => return,
                Err(Unread::Refused(status, why)) => (Response::refusal(status, why), false),
                Ok(head) => match self.admitted(&head) {
                    // The body of a request without the token is not read.
                    Err((status, why)) => (refused_page(&head, status, &why), false),
                    Ok(_) if !place.admit() => {
                        let why = "too many connections: close other tabs of this page";
                        (Response::refusal(503, why), false)
                    }
                    Ok(rest) => {
                        connection.admit();
                        self.visited.store(true, Ordering::SeqCst);
                        match connection.body(&head) {
                            Err(_) => return,
                            Ok(body) => (self.answered(&head, rest, &body), head.keeps),
                        }
                    }
                },
            };
            if connection.answer(&response, keeps).is_err() || !keeps {
                return;
            }
        }
    }

    /// Checks the host, the token, the origin and the method of a request. Returns its path after the token, or a refusal.
    fn admitted<'h>(&self, head: &'h Head) -> Result<&'h str, Refused> {
        let refused = |why: &str| Err((403, why.to_owned()));
        if !head.host.as_deref().is_some_and(|h| self.access.is_host(h)) {
            return refused("this is not the address the server printed");
        }
        let Some(rest) = self.access.rest(&head.path) else {
            return refused(
                "the token in the address is missing, or belongs to a server that is no longer \
                 running",
            );
        };
        match head.method.as_str() {
            "GET" => match &head.origin {
                Some(origin) if !self.access.is_origin(origin) => refused("a foreign origin"),
                _ => Ok(rest),
            },
            "POST" => match &head.origin {
                Some(origin) if self.access.is_origin(origin) => Ok(rest),
                _ => refused("a foreign origin"),
            },
            _ => Err((405, "expected GET or POST".to_owned())),
        }
    }

    fn answered(&self, head: &Head, rest: &str, body: &[u8]) -> Response {
        if head.method == "GET" {
            let report = rest.strip_prefix("report/").map(|n| self.report(n));
            let found = report.unwrap_or_else(|| match rest {
                "" if self.file.get().is_none() => page::file("start.html"),
                _ => page::file(rest),
            });
            return found.unwrap_or_else(|| Response::refusal(404, "there is nothing here"));
        }
        let is_json =
            |kind: &String| kind.split(';').next().map(str::trim) == Some("application/json");
        if !head.content_type.as_ref().is_some_and(is_json) {
            return Response::refusal(415, "expected application/json");
        }
        let answered = match rest {
            "study" => self.study(body),
            "digest" => self.digest(body),
            "solve" => self.with_text(body, |r: &SolveRequest| &r.of, |own, r| self.solved(own, r)),
            "influence" => self.with_text(
                body,
                |r: &InfluenceRequest| &r.of,
                |own, r| own.influence(r),
            ),
            "directions" => self.with_text(body, |r: &Designed| r, |own, of| own.directions(of)),
            "limits" => self.with_text(body, |r: &Designed| r, |own, of| own.limits(of)),
            "csv" => self.csv(body),
            "points" => self.file_of(body, CSV, |own, of| own.points(of)),
            "dxf" => self.file_of(body, DXF, |own, of| own.drawing(of)),
            "report" => self.make_report(body),
            "choices" => message(body).and_then(|()| json(&start::choices())),
            "start" => self.start(body),
            "edit" => self.edit(body),
            "texts" => self.with_text(body, |r: &Designed| r, |own, of| own.texts(&of.design)),
            "tune" => self.tune(body),
            "progress" => self.job(body, |_| ()),
            "cancel" => self.job(body, Job::cancel),
            "save" => self.save(body),
            _ => Err((404, "there is nothing here".to_owned())),
        };
        answered.unwrap_or_else(refusal)
    }

    fn text(&self, digest: &str) -> Result<Arc<dyn Reading>, Refused> {
        let mut texts = locked(&self.texts);
        let place = texts.iter().rposition(|text| text.digest() == digest);
        let found = place.and_then(|place| texts.remove(place)).ok_or_else(|| {
            let why = "the server has another version of the study: reload the page";
            (410, why.to_owned())
        })?;
        // The used text moves to the end, so the server keeps it longer.
        texts.push_back(found.clone());
        Ok(found)
    }

    fn remember(&self, opened: Arc<dyn Reading>) -> Arc<dyn Reading> {
        let mut texts = locked(&self.texts);
        texts.retain(|text| text.digest() != opened.digest());
        texts.push_back(opened.clone());
        if texts.len() > TEXTS {
            texts.pop_front();
        }
        opened
    }

    /// Reads the study file as it is now, and answers with its overview.
    fn study(&self, body: &[u8]) -> Result<Response, Refused> {
        let () = message(body)?;
        let opened = self.file()?.read().map_err(|why| (422, why))?;
        let opened = self.remember(opened);
        json(&opened.overview())
    }

    /// Answers with the SHA-256 of the study file's text as it is now.
    fn digest(&self, body: &[u8]) -> Result<Response, Refused> {
        let () = message(body)?;
        json(&self.file()?.digest().map_err(|why| (422, why))?)
    }

    /// Writes a new study and serves it from now on.
    fn start(&self, body: &[u8]) -> Result<Response, Refused> {
        let request: StartRequest = message(body)?;
        let _one_at_a_time = locked(&self.saving);
        if self.file.get().is_some() {
            let why = "this server already has a study: reload the page";
            return Err((409, why.to_owned()));
        }
        let refused = |why: String| (422, why);
        let path = start::start(&self.directory, &request).map_err(refused)?;
        let file = Files::at(&path).map_err(|e| refused(format!("{}: {e}", path.display())))?;
        let opened = file.read().map_err(refused)?;
        let saved = Saved {
            file: name_of(file.path()),
            digest: opened.digest().to_owned(),
        };
        self.take(file, opened).map_err(refused)?;
        json(&saved)
    }

    /// Changes values in a study text of the server, and answers with the overview of the new text. The file does not change.
    fn edit(&self, body: &[u8]) -> Result<Response, Refused> {
        let request: EditRequest = message(body)?;
        let opened = self.text(&request.digest)?;
        let edited = opened.edited(&request.edits);
        let edited = self.remember(edited.map_err(|why| (422, why))?);
        json(&edited.overview())
    }

    /// Answers a request about a design by `answer`. `of` returns the design of the request.
    fn with_text<R: DeserializeOwned, A: Serialize>(
        &self,
        body: &[u8],
        of: impl Fn(&R) -> &Designed,
        answer: impl Fn(&dyn Reading, &R) -> Result<A, String>,
    ) -> Result<Response, Refused> {
        let request: R = message(body)?;
        let opened = self.text(&of(&request).digest)?;
        json(&answer(&*opened, &request).map_err(|why| (422, why))?)
    }

    /// Answers a dragged point, unless a later request of the same page stops the work.
    fn solved(&self, own: &dyn Reading, request: &SolveRequest) -> Result<SolvedAnswer, String> {
        let turn = request.turn.map(|turn| self.turns.begin(turn));
        let stop = turn
            .as_ref()
            .map_or_else(Stop::default, |turn| turn.stop.clone());
        let answer = stoppable(&stop, || own.solved(request, &stop));
        answer.unwrap_or_else(|| Err(STOPPED.to_owned()))
    }

    /// Answers with an exported file of a design. `kind` is the media type of the file.
    fn file_of(
        &self,
        body: &[u8],
        kind: &'static str,
        made: impl Fn(&dyn Reading, &Designed) -> Result<Vec<u8>, String>,
    ) -> Result<Response, Refused> {
        let of: Designed = message(body)?;
        let file = made(&*self.text(&of.digest)?, &of).map_err(|why| (422, why))?;
        Ok(Response::new(200, kind, file))
    }

    /// Answers with the curves of a design, or with the load cases of a car, as CSV.
    fn csv(&self, body: &[u8]) -> Result<Response, Refused> {
        let request: CurvesRequest = message(body)?;
        let opened = self.text(&request.digest)?;
        let file = opened.csv(&request.design, request.motion.as_deref());
        Ok(Response::new(200, CSV, file.map_err(|why| (422, why))?))
    }

    fn tune(&self, body: &[u8]) -> Result<Response, Refused> {
        let request: TuneRequest = message(body)?;
        let opened = self.text(&request.of.digest)?;
        let mut job = locked(&self.job);
        if job.as_ref().is_some_and(|job| job.is_running()) {
            return Err((
                409,
                "another tuning is running, perhaps in another tab".into(),
            ));
        }
        let number = job.as_ref().map_or(1, |job| job.number() + 1);
        let tuning = opened.tuning(&request);
        let begun = tuning.and_then(|run| Job::begin(number, run));
        let begun = begun.map_err(|why| (422, why))?;
        json(&job.insert(begun).state())
    }

    fn job(&self, body: &[u8], what: impl Fn(&Job)) -> Result<Response, Refused> {
        let request: JobRequest = message(body)?;
        let job = locked(&self.job).clone();
        let job = job.filter(|job| job.number() == request.job);
        let job = job.ok_or((404, "there is no such tuning".to_owned()))?;
        what(&job);
        json(&job.state())
    }

    fn save(&self, body: &[u8]) -> Result<Response, Refused> {
        let request: SaveRequest = message(body)?;
        let opened = self.text(&request.of.digest)?;
        let design = &request.of.design;
        let _one_at_a_time = locked(&self.saving);
        let refused = |why| match why {
            NotSaved::Changed(why) => (409, why),
            NotSaved::Refused(why) => (422, why),
        };
        let saved = match &request.name {
            None => {
                let over = Over {
                    known: request.base.as_deref(),
                    anyway: request.anyway,
                };
                let written = opened.save(design, &over).map_err(refused)?;
                let now = self.remember(written.now);
                Saved {
                    file: written.files.join(", "),
                    digest: now.digest().to_owned(),
                }
            }
            Some(name) => {
                let file = opened.save_as(design, name, request.anyway);
                Saved {
                    file: file.map_err(refused)?,
                    digest: opened.digest().to_owned(),
                }
            }
        };
        json(&saved)
    }

    /// Makes the report page of a design. Answers with the path of this page on the server.
    fn make_report(&self, body: &[u8]) -> Result<Response, Refused> {
        let of: Designed = message(body)?;
        let opened = self.text(&of.digest)?;
        let html = opened.report(&of).map_err(|why| (422, why))?;
        let mut reports = locked(&self.reports);
        let number = reports.back().map_or(1, |(number, _)| number + 1);
        reports.push_back((number, html.into()));
        if reports.len() > REPORTS {
            reports.pop_front();
        }
        json(&format!("report/{number}"))
    }

    /// Report page with this number. `None` if the server does not store it any more.
    fn report(&self, number: &str) -> Option<Response> {
        let number: u64 = number.parse().ok()?;
        let reports = locked(&self.reports);
        let (_, html) = reports.iter().find(|(n, _)| *n == number)?;
        let body = html.as_bytes().to_vec();
        Some(Response {
            // The report contains its own policy for scripts. The report loads nothing and connects to nothing.
            policy: "frame-ancestors 'none'".into(),
            ..Response::new(200, "text/html; charset=utf-8", body)
        })
    }
}

/// Response that refuses a request: a short HTML page if a person may have opened the address, else plain text.
fn refused_page(head: &Head, status: u16, why: &str) -> Response {
    if head.method != "GET" || head.origin.is_some() || status != 403 {
        return Response::refusal(status, why);
    }
    let body = include_str!("page/refused.html").replace("{why}", why);
    Response::new(status, "text/html; charset=utf-8", body.into_bytes())
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // The stored data are complete even after a panic in a thread, so a poisoned lock is harmless.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn message<R: DeserializeOwned>(body: &[u8]) -> Result<R, Refused> {
    serde_json::from_slice(body).map_err(|e| {
        (
            400,
            format!("the server does not understand this request of the page: {e}"),
        )
    })
}

fn json(answer: &impl Serialize) -> Result<Response, Refused> {
    let text = serde_json::to_vec(answer).map_err(|e| (500, e.to_string()))?;
    Ok(Response::new(200, "application/json", text))
}

/// Response that refuses a request with an HTTP status. A design that cannot be solved, a changed file and a text that the server
/// no longer stores are usual cases. They get status 200, and the JSON answer has the real status, because browsers write refusals
/// to the console as errors.
fn refusal((status, why): Refused) -> Response {
    match status {
        409 | 410 | 422 => {
            let text = serde_json::json!({"refused": status, "why": why}).to_string();
            Response::new(200, "application/json", text.into_bytes())
        }
        _ => Response::refusal(status, &why),
    }
}
