use pinswitch_model::inference::*; use pinswitch_model::rig::*;
fn main(){ for path in std::env::args().skip(1){ let t=PlateauTable::read(std::fs::File::open(&path).unwrap(),&path).unwrap();
 let frame=Frame::new(&t.rows); let mut obs=Observations::new(&frame,&t.rows).unwrap();
 let s=select(&Model::baseline(frame.clone()),&mut obs,Levels::default());
 let r=&s.augmented.residual_n;
 println!("{path}");
 for c in &obs.cells { let n=c.len() as f64; let m=c.iter().map(|i|r[*i]).sum::<f64>()/n; let mut d:Vec<f64>=c.iter().map(|i|(r[*i]-m).abs()).collect(); d.sort_by(f64::total_cmp); let sd=d[d.len()/2]*1.48; let row=&t.rows[c[0]]; 
  println!("{} {} {} {:.1} {} n{} mean {:+.4} sd {:.4}",row.series,frame.conditions[obs.points[c[0]].condition].name(),row.sweep.word(),row.load_n,obs.points[c[0]].sign,n,m,sd);} }}
